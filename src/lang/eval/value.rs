//! Values of the language: numbers, vectors and colours are one kind ([`Num`]), everything else is shared.

use crate::lang::desc::Desc;
use crate::lang::syntax::{Symbol, TokenFile};
use glam::DVec3;
use std::rc::Rc;

/// A float, vector (2–5 components) or colour (red, green, blue, filter, transmit).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Num {
    /// Components; those past `len` are 0, except that a float is kept in the first only.
    pub v: [f64; 5],
    /// 1 for a float, else the number of components.
    pub len: u8,
    /// Whether it was written as a colour.
    pub is_color: bool,
}

impl Num {
    /// A float.
    pub fn float(v: f64) -> Num {
        Num {
            v: [v, 0.0, 0.0, 0.0, 0.0],
            len: 1,
            is_color: false,
        }
    }

    /// A vector of three.
    pub fn vec3(v: DVec3) -> Num {
        Num {
            v: [v.x, v.y, v.z, 0.0, 0.0],
            len: 3,
            is_color: false,
        }
    }

    /// A colour: red, green, blue, filter, transmit.
    pub fn color(v: [f64; 5]) -> Num {
        Num {
            v,
            len: 5,
            is_color: true,
        }
    }

    /// Whether it is a single number.
    pub fn is_float(&self) -> bool {
        self.len == 1
    }

    /// All five components: a float stands for all, a shorter vector is padded with 0.
    pub fn five(&self) -> [f64; 5] {
        if self.len == 1 { [self.v[0]; 5] } else { self.v }
    }

    /// The first three components of [`Num::five`].
    pub fn xyz(&self) -> DVec3 {
        let [x, y, z, ..] = self.five();
        DVec3::new(x, y, z)
    }

    /// Applies an operation component by component; a float meets every component of a vector.
    pub fn zip(self, other: Num, op: impl Fn(f64, f64) -> f64) -> Num {
        if self.len == 1 && other.len == 1 {
            return Num::float(op(self.v[0], other.v[0]));
        }
        let len = self.len.max(other.len);
        let (a, b) = (self.five(), other.five());
        let mut v = [0.0; 5];
        for i in 0..usize::from(len).min(5) {
            v[i] = op(a[i], b[i]);
        }
        Num {
            v,
            len,
            is_color: self.is_color || other.is_color,
        }
    }

    /// Applies a function to every component.
    pub fn map(self, op: impl Fn(f64) -> f64) -> Num {
        self.zip(Num::float(0.0), |a, _| op(a))
    }
}

/// An array of up to five dimensions, row by row.
#[derive(Clone, Debug)]
pub struct Array {
    /// Its sizes.
    pub dims: Vec<usize>,
    /// Its elements; those never set are `None`.
    pub items: Vec<Option<Value>>,
}

/// A macro: its parameters and where its body stands.
#[derive(Debug)]
pub struct Macro {
    /// Its name.
    pub name: Symbol,
    /// Its parameters.
    pub params: Vec<Symbol>,
    /// The file of its body.
    pub file: Rc<TokenFile>,
    /// First token of the body.
    pub start: u32,
    /// The `#end`.
    pub end: u32,
}

/// A `function(…) {…}`.
#[derive(Debug)]
pub struct Function {
    /// Its parameters, x y z unless others are named.
    pub params: Vec<Symbol>,
    /// The file of its body.
    pub file: Rc<TokenFile>,
    /// First token of the body.
    pub start: u32,
    /// The closing brace.
    pub end: u32,
    /// Whether it is an expression that can be called (a pattern or pigment function cannot yet).
    pub is_expression: bool,
}

/// What an identifier can stand for.
#[derive(Clone, Debug)]
pub enum Value {
    /// Float, vector or colour.
    Num(Num),
    /// String.
    Text(Rc<str>),
    /// Array.
    Array(Rc<Array>),
    /// Macro.
    Macro(Rc<Macro>),
    /// Function.
    Function(Rc<Function>),
    /// Something written as a block: an object, a texture, a camera.
    Desc(Desc),
    /// The result of a declaration that failed: using it fails again, silently.
    Poison,
}

impl Value {
    /// What messages call it, with an article.
    pub fn kind(&self) -> &'static str {
        match self {
            Value::Num(n) if n.is_color => "a colour",
            Value::Num(n) if n.is_float() => "a number",
            Value::Num(_) => "a vector",
            Value::Text(_) => "a string",
            Value::Array(_) => "an array",
            Value::Macro(_) => "a macro",
            Value::Function(_) => "a function",
            Value::Desc(d) => d.kind(),
            Value::Poison => "a failed declaration",
        }
    }
}
