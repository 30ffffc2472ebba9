#include "colors.inc"
sphere { 0, 2 pigment { rgb .5 } }
