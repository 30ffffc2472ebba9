//! Patterns: read in full, drawn as their average for now.

use crate::lang::eval::{Interp, Parsed, T as Next};
use crate::lang::syntax::Word;

/// Whether a word names a pattern.
pub fn is_pattern(w: Word) -> bool {
    use Word::*;
    matches!(
        w,
        Agate
            | Aoi
            | Average
            | Boxed
            | Bozo
            | Brick
            | Bumps
            | Cells
            | Checker
            | Crackle
            | Cylindrical
            | DensityFile
            | Dents
            | Facets
            | Function
            | Gradient
            | Granite
            | Hexagon
            | ImageMap
            | ImagePattern
            | Julia
            | Leopard
            | Magnet
            | Mandel
            | Marble
            | Object
            | Onion
            | PigmentPattern
            | Planar
            | Quilted
            | Radial
            | Ripples
            | Slope
            | Spherical
            | Spiral1
            | Spiral2
            | Spotted
            | Square
            | Tiling
            | Pavement
            | Triangular
            | Toroidal
            | Waves
            | Wood
            | Wrinkles
            | BumpMap
    )
}

impl Interp<'_> {
    /// A pattern's word and its own arguments; colours that follow stay.
    pub fn pattern(&mut self, w: Word) -> Parsed<()> {
        use Word::*;
        self.bump();
        match w {
            Gradient | Slope => self.skip_arguments(),
            Agate | Checker | Brick | Hexagon | Square | Triangular | Bozo | Granite | Wood | Marble => Ok(()),
            Julia | Magnet | Mandel | Spiral1 | Spiral2 | DensityFile | Quilted | Crackle | Facets | Tiling
            | Pavement => {
                // Magnet 1 mandel 2, spiral1 5, density_file df3 "name": words, numbers and strings.
                loop {
                    match self.peek().t {
                        Next::Word(Df3 | Type | Mandel | Julia) => {
                            self.bump();
                        }
                        Next::Number(_) | Next::Mark(b'<' | b'-' | b'(') | Next::Text => self.skip_arguments()?,
                        Next::Mark(b',') => {
                            self.bump();
                        }
                        Next::Name(_) if !self.starts_color() && self.starts_expr() => {
                            self.expr()?;
                        }
                        _ => return Ok(()),
                    }
                }
            }
            Function | ImageMap | BumpMap | ImagePattern | PigmentPattern | Object => {
                while self.starts_expr() {
                    self.expr()?;
                    self.comma();
                }
                if self.peek().t == Next::Mark(b'{') {
                    self.skip_block()
                } else {
                    self.skip_arguments()
                }
            }
            _ => {
                if matches!(self.peek().t, Next::Number(_)) {
                    self.expr()?; // `bumps 0.4` in a normal
                }
                Ok(())
            }
        }
    }

    /// Words that change a pattern; false if the word is none.
    pub fn pattern_modifier(&mut self, w: Word) -> Parsed<bool> {
        use Word::*;
        match w {
            Turbulence | Octaves | Omega | Lambda | Frequency | Phase | Warp | UvMapping | Interpolate | MapType
            | Once | RampWave | TriangleWave | SineWave | ScallopWave | CubicWave | PolyWave | BumpSize
            | NoBumpScale | Accuracy | Mortar | BrickSize | AgateTurb | Solid | Metric | Offset | Form | Control0
            | Control1 | NoiseGenerator | Interior | Exponent | Exterior | UseIndex | UseColor | UseAlpha | Coords
            | Size | NumberOfWaves | SlopeMap | NormalMap | QuickColor | Type | DensityMap | Sturm | Filter
            | Transmit => {
                self.bump();
                if w == QuickColor {
                    self.color()?;
                } else if matches!(w, Filter | Transmit) {
                    self.eat_word(All);
                    self.skip_arguments()?;
                } else if w == Turbulence || w == Phase || w == Frequency {
                    self.expr()?;
                } else if w == UvMapping {
                    // A flag; a number behind it belongs to something else.
                } else {
                    self.skip_arguments()?;
                }
                Ok(true)
            }
            _ => Ok(false),
        }
    }
}
