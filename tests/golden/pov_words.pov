// POV-Ray's own words: finish, filter, reflection, spotlight, area_light, background.
#version 3.7;
global_settings { assumed_gamma 1 }
camera { location <0, 2.5, -7> look_at <0, 0.7, 0> right x angle 42 }
background { rgb <0.1, 0.15, 0.3> }
light_source { <4, 6, -5>, rgb 0.8 area_light x*2, z*2, 4, 4 }
light_source { <-4, 5, -3>, rgb <1, .8, .6> spotlight point_at <-1, 0, 0> radius 12 falloff 22 tightness 2 }
plane { y, 0 pigment { rgb <.7, .6, .5> } finish { diffuse 0.8 } }
sphere { <-1.6, 0.8, 0>, 0.8 pigment { rgb <.9,.2,.1> } finish { diffuse 0.7 phong 0.8 phong_size 30 } }
sphere { <0.2, 0.8, 0>, 0.8 pigment { rgb <.3,.4,.9> } finish { diffuse 0.5 specular 0.6 roughness 0.02 reflection { 0.1, 0.6 } } }
sphere { <2, 0.8, 0>, 0.8 pigment { rgbf <.9,1,.9,.85> } finish { diffuse 0.1 reflection 0.1 } interior { ior 1.4 } }
box { <-1, 0, -2.2>, <1, 0.8, -2.1> pigment { rgbt <.9,.7,.2,.6> } }
