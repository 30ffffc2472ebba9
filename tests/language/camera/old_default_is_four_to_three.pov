#version 3.7;
render { resolution <640, 320> }
camera { location 0 }
