//! Names and what they stand for. One scope for globals, one for each include file and macro call; look-up goes from
//! the innermost outwards, so a macro sees its caller's locals, as in POV-Ray.

use super::value::Value;
use crate::lang::syntax::Symbol;
use std::collections::HashMap;
use std::hash::{BuildHasherDefault, Hasher};

/// Hashes a symbol by one multiplication: symbols are small consecutive numbers.
#[derive(Default)]
pub struct SymbolHasher(u64);

impl Hasher for SymbolHasher {
    fn finish(&self) -> u64 {
        self.0
    }

    fn write(&mut self, bytes: &[u8]) {
        for &b in bytes {
            self.write_u32(u32::from(b));
        }
    }

    fn write_u32(&mut self, i: u32) {
        self.0 = (self.0 ^ u64::from(i)).wrapping_mul(0x9e37_79b9_7f4a_7c15);
    }
}

type Table = HashMap<Symbol, Slot, BuildHasherDefault<SymbolHasher>>;

/// What a scope holds under a name.
#[derive(Clone, Debug)]
enum Slot {
    Value(Value),
    /// A parameter passed by reference: the name in another scope.
    Reference(Place),
}

/// A name in one scope.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Place {
    /// Index of the scope.
    pub scope: usize,
    /// The name there.
    pub name: Symbol,
}

/// All scopes, globals first.
#[derive(Debug)]
pub struct Scopes {
    tables: Vec<Table>,
}

impl Default for Scopes {
    fn default() -> Scopes {
        Scopes {
            tables: vec![Table::default()],
        }
    }
}

impl Scopes {
    /// Opens a scope and returns its index.
    pub fn open(&mut self) -> usize {
        self.tables.push(Table::default());
        self.tables.len() - 1
    }

    /// Closes scopes until `len` are left (the global one always is).
    pub fn close_to(&mut self, len: usize) {
        self.tables.truncate(len.max(1));
    }

    /// How many scopes are open.
    pub fn len(&self) -> usize {
        self.tables.len()
    }

    /// Where the innermost thing of this name is kept, references followed.
    pub fn find(&self, name: Symbol) -> Option<Place> {
        for (scope, table) in self.tables.iter().enumerate().rev() {
            match table.get(&name) {
                Some(Slot::Reference(place)) => return Some(*place),
                Some(Slot::Value(_)) => return Some(Place { scope, name }),
                None => {}
            }
        }
        None
    }

    /// The value of a name.
    pub fn get(&self, name: Symbol) -> Option<&Value> {
        self.at(self.find(name)?)
    }

    /// The value at a place.
    pub fn at(&self, place: Place) -> Option<&Value> {
        match self.tables.get(place.scope)?.get(&place.name)? {
            Slot::Value(v) => Some(v),
            Slot::Reference(_) => None,
        }
    }

    /// The value at a place, to be changed.
    pub fn at_mut(&mut self, place: Place) -> Option<&mut Value> {
        match self.tables.get_mut(place.scope)?.get_mut(&place.name)? {
            Slot::Value(v) => Some(v),
            Slot::Reference(_) => None,
        }
    }

    /// Where `#declare` writes: to the local or parameter of that name if there is one, else to the globals.
    pub fn declare_place(&self, name: Symbol) -> Place {
        self.find(name).unwrap_or(Place { scope: 0, name })
    }

    /// Where `#local` writes: to the given scope, through a reference if the name is a parameter there.
    pub fn local_place(&self, scope: usize, name: Symbol) -> Place {
        match self.tables.get(scope).and_then(|t| t.get(&name)) {
            Some(Slot::Reference(place)) => *place,
            _ => Place { scope, name },
        }
    }

    /// Writes a value.
    pub fn set(&mut self, place: Place, value: Value) {
        if let Some(table) = self.tables.get_mut(place.scope) {
            table.insert(place.name, Slot::Value(value));
        }
    }

    /// Makes a name stand for another one.
    pub fn refer(&mut self, scope: usize, name: Symbol, target: Place) {
        if let Some(table) = self.tables.get_mut(scope) {
            table.insert(name, Slot::Reference(target));
        }
    }

    /// Forgets the innermost thing of this name.
    pub fn remove(&mut self, name: Symbol) {
        if let Some(place) = self.find(name)
            && let Some(table) = self.tables.get_mut(place.scope)
        {
            table.remove(&place.name);
        }
    }

    /// All names that are visible.
    pub fn names(&self) -> impl Iterator<Item = Symbol> {
        self.tables.iter().flat_map(|t| t.keys().copied())
    }
}
