//! The table of words: every word the language knows, reserved as in POV-Ray or contextual.
//!
//! A reserved word can never be declared. A contextual word is one that POV-Ray lacks: it means what the language
//! says only as long as the scene declares nothing of that name, so that old scenes keep loading.

macro_rules! words {
    (reserved: $($r:ident $rt:literal)*; contextual: $($c:ident $ct:literal)*;) => {
        /// A word of the language.
        #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
        #[repr(u16)]
        #[allow(missing_docs)]
        pub enum Word { $($r,)* $($c,)* }

        /// All words, reserved ones first, in the order of the enum.
        pub const ALL: &[(Word, &str)] = &[$((Word::$r, $rt),)* $((Word::$c, $ct),)*];

        /// How many of [`ALL`] are reserved.
        const RESERVED: usize = [$($rt,)*].len();
    };
}

/// Other spellings of words.
pub const ALIASES: &[(&str, Word)] = &[
    ("colour", Word::Color),
    ("colour_map", Word::ColorMap),
    ("fade_colour", Word::FadeColor),
    ("quick_colour", Word::QuickColor),
    ("use_colour", Word::UseColor),
];

impl Word {
    /// How the word is written.
    pub fn text(self) -> &'static str {
        ALL.get(self as usize).map_or("", |w| w.1)
    }

    /// Whether scenes may declare it, which then hides the word.
    pub fn is_contextual(self) -> bool {
        self as usize >= RESERVED
    }
}

#[rustfmt::skip]
words! {
    reserved:
    Abs "abs" Absorption "absorption" Accuracy "accuracy" Acos "acos" Acosh "acosh" Adaptive "adaptive"
    AdcBailout "adc_bailout" Agate "agate" AgateTurb "agate_turb" All "all" AllIntersections "all_intersections"
    Alpha "alpha" Altitude "altitude" AlwaysSample "always_sample" Ambient "ambient" AmbientLight "ambient_light"
    Angle "angle" Aoi "aoi" Aperture "aperture" ArcAngle "arc_angle" AreaLight "area_light"
    AreaIllumination "area_illumination" Array "array" Asc "asc" Ascii "ascii" Asin "asin" Asinh "asinh"
    AssumedGamma "assumed_gamma" Atan "atan" Atan2 "atan2" Atanh "atanh" Albedo "albedo" Average "average"
    BSpline "b_spline" Background "background" BezierSpline "bezier_spline" BicubicPatch "bicubic_patch"
    BlackHole "black_hole" Blob "blob" Blue "blue" BlurSamples "blur_samples" BoundedBy "bounded_by" Box "box"
    Boxed "boxed" Bozo "bozo" Brick "brick" BrickSize "brick_size" Brightness "brightness" Brilliance "brilliance"
    BumpMap "bump_map" BumpSize "bump_size" Bumps "bumps" Camera "camera" Caustics "caustics" Ceil "ceil"
    Cells "cells" Charset "charset" Checker "checker" Chr "chr" Circular "circular" ClippedBy "clipped_by"
    Clock "clock" ClockDelta "clock_delta" ClockOn "clock_on" Collect "collect" Color "color" ColorMap "color_map"
    Component "component" Composite "composite" Concat "concat" Cone "cone" Confidence "confidence"
    ConicSweep "conic_sweep" ConserveEnergy "conserve_energy" ContainedBy "contained_by" Control0 "control0"
    Control1 "control1" Coords "coords" Cos "cos" Cosh "cosh" Count "count" Crackle "crackle" Crand "crand"
    Cube "cube" Cubic "cubic" CubicSpline "cubic_spline" CubicWave "cubic_wave" CutawayTextures "cutaway_textures"
    Cylinder "cylinder" Cylindrical "cylindrical" Defined "defined" Degrees "degrees" Density "density"
    DensityFile "density_file" DensityMap "density_map" Dents "dents" Df3 "df3" Difference "difference"
    Diffuse "diffuse" DimensionSize "dimension_size" Dimensions "dimensions" Direction "direction" Disc "disc"
    Dispersion "dispersion" DispersionSamples "dispersion_samples" DistExp "dist_exp" Distance "distance" Div "div"
    DoubleIlluminate "double_illuminate" Eccentricity "eccentricity" Emission "emission" ErrorBound "error_bound"
    Evaluate "evaluate" Exp "exp" ExpandThresholds "expand_thresholds" Exponent "exponent" Exterior "exterior"
    Extinction "extinction" FaceIndices "face_indices" Facets "facets" FadeColor "fade_color"
    FadeDistance "fade_distance" FadePower "fade_power" Falloff "falloff" FalloffAngle "falloff_angle" False "false"
    FileExists "file_exists" Filter "filter" FinalClock "final_clock" FinalFrame "final_frame" Finish "finish"
    Fisheye "fisheye" Flatness "flatness" Flip "flip" Floor "floor" FocalPoint "focal_point" Fog "fog"
    FogAlt "fog_alt" FogOffset "fog_offset" FogType "fog_type" Form "form" FrameNumber "frame_number"
    Frequency "frequency" Fresnel "fresnel" Function "function" Gather "gather" Gif "gif"
    GlobalLights "global_lights" GlobalSettings "global_settings" Gradient "gradient" Granite "granite" Gray "gray"
    GrayThreshold "gray_threshold" Green "green" HeightField "height_field" Hexagon "hexagon" HfGray16 "hf_gray_16"
    Hierarchy "hierarchy" Hollow "hollow" Hypercomplex "hypercomplex" ImageHeight "image_height"
    ImageMap "image_map" ImagePattern "image_pattern" ImageWidth "image_width" InitialClock "initial_clock"
    InitialFrame "initial_frame" Inside "inside" InsideVector "inside_vector" Int "int" Interior "interior"
    InteriorTexture "interior_texture" Internal "internal" Interpolate "interpolate" Intersection "intersection"
    Intervals "intervals" Inverse "inverse" Ior "ior" Irid "irid" IridWavelength "irid_wavelength"
    Isosurface "isosurface" Jitter "jitter" Jpeg "jpeg" Julia "julia" JuliaFractal "julia_fractal" Lambda "lambda"
    Lathe "lathe" Leopard "leopard" LightGroup "light_group" LightSource "light_source" LinearSpline "linear_spline"
    LinearSweep "linear_sweep" Ln "ln" LoadFile "load_file" Location "location" Log "log" LookAt "look_at"
    LooksLike "looks_like" LowErrorFactor "low_error_factor" Magnet "magnet" MajorRadius "major_radius"
    Mandel "mandel" MapType "map_type" Marble "marble" Material "material" MaterialMap "material_map"
    Matrix "matrix" Max "max" MaxExtent "max_extent" MaxGradient "max_gradient" MaxIntersections "max_intersections"
    MaxIteration "max_iteration" MaxSample "max_sample" MaxTrace "max_trace" MaxTraceLevel "max_trace_level"
    Media "media" MediaAttenuation "media_attenuation" MediaInteraction "media_interaction" Merge "merge"
    Mesh "mesh" Mesh2 "mesh2" MeshCamera "mesh_camera" Metallic "metallic" Method "method" Metric "metric" Min "min"
    MinExtent "min_extent" MinimumReuse "minimum_reuse" Mod "mod" Mortar "mortar" NaturalSpline "natural_spline"
    NearestCount "nearest_count" No "no" NoBumpScale "no_bump_scale" NoImage "no_image" NoReflection "no_reflection"
    NoShadow "no_shadow" NoiseGenerator "noise_generator" Normal "normal" NormalIndices "normal_indices"
    NormalMap "normal_map" NormalVectors "normal_vectors" Now "now" NumberOfWaves "number_of_waves" Object "object"
    Octaves "octaves" Off "off" Offset "offset" Omega "omega" Omnimax "omnimax" On "on" Once "once" Onion "onion"
    Open "open" Orient "orient" Orientation "orientation" Orthographic "orthographic" Ovus "ovus"
    Panoramic "panoramic" Parallel "parallel" Parametric "parametric" PassThrough "pass_through" Pattern "pattern"
    Perspective "perspective" Pgm "pgm" Phase "phase" Phong "phong" PhongSize "phong_size" Photons "photons" Pi "pi"
    Pigment "pigment" PigmentMap "pigment_map" PigmentPattern "pigment_pattern" Planar "planar" Plane "plane"
    Png "png" PointAt "point_at" Poly "poly" PolyWave "poly_wave" Polygon "polygon" Pot "pot" Pow "pow" Ppm "ppm"
    Precision "precision" Precompute "precompute" PretraceEnd "pretrace_end" PretraceStart "pretrace_start"
    Prism "prism" Prod "prod" ProjectedThrough "projected_through" Pwr "pwr" QuadraticSpline "quadratic_spline"
    Quadric "quadric" Quartic "quartic" Quaternion "quaternion" QuickColor "quick_color" Quilted "quilted"
    Radial "radial" Radians "radians" Radiosity "radiosity" Radius "radius" Rainbow "rainbow" RampWave "ramp_wave"
    Rand "rand" Ratio "ratio" Reciprocal "reciprocal" RecursionLimit "recursion_limit" Red "red"
    Reflection "reflection" ReflectionExponent "reflection_exponent" Refraction "refraction" Repeat "repeat"
    Rgb "rgb" Rgbf "rgbf" Rgbft "rgbft" Rgbt "rgbt" Right "right" Ripples "ripples" Rotate "rotate"
    Roughness "roughness" Samples "samples" SaveFile "save_file" Scale "scale" ScallopWave "scallop_wave"
    Scattering "scattering" Seed "seed" Select "select" Shadowless "shadowless" Sin "sin" SineWave "sine_wave"
    Sinh "sinh" Size "size" Sky "sky" SkySphere "sky_sphere" Slice "slice" Slope "slope" SlopeMap "slope_map"
    Smooth "smooth" SmoothTriangle "smooth_triangle" Solid "solid" Sor "sor" Spacing "spacing" Specular "specular"
    Sphere "sphere" SphereSweep "sphere_sweep" Spherical "spherical" Spiral1 "spiral1" Spiral2 "spiral2"
    Spline "spline" SplitUnion "split_union" Spotlight "spotlight" Spotted "spotted" Sqr "sqr" Sqrt "sqrt"
    Srgb "srgb" Srgbf "srgbf" Srgbft "srgbft" Srgbt "srgbt" Str "str" Strcmp "strcmp" Strength "strength"
    Strlen "strlen" Strlwr "strlwr" Strupr "strupr" Sturm "sturm" Subsurface "subsurface" Substr "substr" Sum "sum"
    Superellipsoid "superellipsoid" Sys "sys" T "t" Tan "tan" Tanh "tanh" Target "target" Text "text"
    Texture "texture" TextureList "texture_list" TextureMap "texture_map" Tga "tga" Thickness "thickness"
    Threshold "threshold" Tiff "tiff" Tightness "tightness" Tile2 "tile2" Tiles "tiles" Tolerance "tolerance"
    Toroidal "toroidal" Torus "torus" Trace "trace" Transform "transform" Translate "translate"
    Translucency "translucency" Transmit "transmit" Triangle "triangle" TriangleWave "triangle_wave" True "true"
    Ttf "ttf" TurbDepth "turb_depth" Turbulence "turbulence" Type "type" U "u" USteps "u_steps"
    UltraWideAngle "ultra_wide_angle" Union "union" Up "up" UseAlpha "use_alpha" UseColor "use_color"
    UseIndex "use_index" Utf8 "utf8" UvIndices "uv_indices" UvMapping "uv_mapping" UvVectors "uv_vectors" V "v"
    VSteps "v_steps" Val "val" Variance "variance" VaxisRotate "vaxis_rotate" Vcross "vcross" Vdot "vdot"
    Version "version" VertexVectors "vertex_vectors" Vlength "vlength" Vnormalize "vnormalize" Vrotate "vrotate"
    Vstr "vstr" Vturbulence "vturbulence" Warp "warp" WaterLevel "water_level" Waves "waves" Width "width"
    Wood "wood" Wrinkles "wrinkles" X "x" Y "y" Yes "yes" Z "z";
    contextual:
    Abbe "abbe" AlphaMode "alpha_mode" Anisotropy "anisotropy" AnisotropyDirection "anisotropy_direction"
    AnisotropyRotation "anisotropy_rotation"
    Animation "animation" AttenuationColor "attenuation_color" AttenuationDistance "attenuation_distance" Backdrop "backdrop"
    BaseColor "base_color" BlackmanHarris "blackman_harris" Cameras "cameras" Channel "channel" Clearcoat "clearcoat"
    ClearcoatNormal "clearcoat_normal" ClearcoatRoughness "clearcoat_roughness" Depth "depth" DiffuseTransmission "diffuse_transmission"
    DiffuseTransmissionColor "diffuse_transmission_color" Environment "environment" Error "error"
    FocusDistance "focus_distance" Gaussian "gaussian" Glass "glass" Glossy "glossy" Gltf "gltf" Image "image"
    Iridescence "iridescence" IridescenceIor "iridescence_ior" IridescenceThickness "iridescence_thickness"
    LensRadius "lens_radius" Lights "lights" MaxDepth "max_depth" Metal "metal" Mix "mix" Name "name" Node "node" Obj "obj"
    Opacity "opacity" Principled "principled" Render "render" Resolution "resolution" Scene "scene" SheenColor "sheen_color"
    SheenRoughness "sheen_roughness" Shutter "shutter" Sigma "sigma" SpecularColor "specular_color" Spp "spp" Thick "thick"
    Time "time" Translucent "translucent" Transmission "transmission" Variant "variant" Weight "weight"
    NoRadiosity "no_radiosity" Pavement "pavement" Square "square" Tiling "tiling" Triangular "triangular";
}
