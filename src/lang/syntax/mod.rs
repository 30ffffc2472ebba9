//! Text to tokens. The grammar (`grammar/pts.pest`) owns the tokens, `structure` the nesting of directives; what
//! words and brackets mean is decided by `eval` and `lower`.

mod lexer;
mod structure;
pub mod token;
pub mod words;

pub use lexer::lex;
pub use token::{Directive, DirectiveKind, Interner, NONE, Symbol, Token, TokenFile, TokenKind};
pub use words::Word;
