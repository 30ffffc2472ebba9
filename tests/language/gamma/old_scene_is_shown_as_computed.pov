// warn: 2:1 black
sphere { 0, 1 }
sphere { 0, 2 pigment { rgb .5 } }
