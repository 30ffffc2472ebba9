#version 3.7;
sphere { 0, 2 pigment { rgb .5 } }
sphere { 0, 2 pigment { srgb .5 } }
