//! Accessors: typed numbers in views, with strides, normalisation and sparse replacements, all bounds checked.

use super::Loader;
use super::budget::Cost;
use super::buffer::Blob;
use crate::diag::Diagnostic;
use gltf::json;
use json::accessor::ComponentType;
use json::validation::Checked;
use serde_json::Value;
use std::collections::{HashMap, HashSet};
use std::rc::Rc;

/// Numbers of an accessor, `components` per element.
pub(super) struct Numbers {
    /// Numbers per element.
    pub components: usize,
    /// All of them; the length is a multiple of `components`.
    pub values: Vec<f32>,
}

impl Numbers {
    /// How many elements.
    pub fn count(&self) -> usize {
        self.values.len() / self.components
    }

    /// Element `i`, filled up by `fill` where it has fewer than N components; zeros out of range.
    pub fn get<const N: usize>(&self, i: usize, fill: f32) -> [f32; N] {
        let element = self.values.get(i * self.components..(i + 1) * self.components);
        let element = element.unwrap_or(&[]);
        std::array::from_fn(|k| element.get(k).copied().unwrap_or(fill))
    }
}

/// What a reader accepts.
#[derive(Clone, Copy)]
pub(super) struct Wanted {
    /// Allowed numbers of components.
    pub components: &'static [usize],
    /// Integers are normalised even if the accessor does not say so (colours, weights: raw integers have no meaning
    /// there).
    pub normalize: bool,
}

/// Decoded accessors that several primitives share (exporters often split one vertex buffer by material).
#[derive(Default)]
pub(super) struct Cache {
    floats: HashMap<(usize, bool), Rc<Numbers>>,
    held: usize,
    /// Accessors that several primitives refer to, found out when first asked for; only these are kept.
    shared: Option<HashSet<usize>>,
    /// What the accessors of the primitive at hand hold, where its Draco data say so; never kept in `floats`.
    pub supplied: HashMap<usize, Supplied>,
}

/// Packed elements that take the place of an accessor's own.
#[derive(Clone)]
pub(super) struct Supplied {
    /// Type of one component.
    pub kind: ComponentType,
    /// Components of an element.
    pub components: usize,
    /// Whether integers stand for fractions.
    pub normalized: bool,
    /// Elements.
    pub count: usize,
    /// All of them, without gaps.
    pub bytes: Blob,
}

/// The cache is emptied beyond this many numbers.
const CACHE_NUMBERS: usize = 1 << 26;

/// Elements at regular distances.
struct Strided {
    bytes: Blob,
    offset: usize,
    stride: usize,
}

/// An accessor whose every element is known to lie inside its view.
struct Source {
    count: usize,
    components: usize,
    kind: ComponentType,
    normalized: bool,
    base: Option<Strided>,
    sparse: Option<(Vec<u32>, Strided)>,
}

impl Loader<'_> {
    /// The numbers of accessor `index`, referred to at `at`, as f32; normalised integers become fractions.
    pub(super) fn floats(&mut self, index: usize, wanted: Wanted, at: &str) -> Option<Rc<Numbers>> {
        let key = (index, wanted.normalize);
        let supplied = self.accessors.supplied.contains_key(&index);
        if let Some(known) = self.accessors.floats.get(&key).filter(|_| !supplied)
            && wanted.components.contains(&known.components)
        {
            return Some(known.clone());
        }
        let source = self.accessor(index, wanted.components, at)?;
        let normalized = source.normalized || wanted.normalize;
        let kind = source.kind;
        let values = source.collect(|bytes| number(kind, normalized, bytes));
        let numbers = Rc::new(Numbers {
            components: source.components,
            values,
        });
        if supplied || !self.is_shared(index) {
            return Some(numbers);
        }
        if self.accessors.held + numbers.values.len() > CACHE_NUMBERS {
            self.accessors.floats.clear();
            self.accessors.held = 0;
        }
        self.accessors.held += numbers.values.len();
        self.accessors.floats.insert(key, numbers.clone());
        Some(numbers)
    }

    /// Whether more than one attribute of the file's meshes has the accessor's numbers.
    fn is_shared(&mut self, index: usize) -> bool {
        let doc = self.doc;
        let shared = self.accessors.shared.get_or_insert_with(|| {
            fn items(list: Option<&Value>) -> std::slice::Iter<'_, Value> {
                list.and_then(Value::as_array).map_or(&[][..], Vec::as_slice).iter()
            }
            let primitives = items(doc.top("meshes")).flat_map(|mesh| items(mesh.get("primitives")));
            let maps = primitives.flat_map(|p| p.get("attributes").into_iter().chain(items(p.get("targets"))));
            let (mut met, mut shared) = (HashSet::new(), HashSet::new());
            for accessor in maps.filter_map(Value::as_object).flat_map(|map| map.values()) {
                let Some(index) = accessor.as_u64().and_then(|i| usize::try_from(i).ok()) else {
                    continue;
                };
                if !met.insert(index) {
                    shared.insert(index);
                }
            }
            shared
        });
        shared.contains(&index)
    }

    /// The unsigned integers of accessor `index` (indices, joints), `components` per element.
    pub(super) fn integers(&mut self, index: usize, components: &'static [usize], at: &str) -> Option<Vec<u32>> {
        let source = self.accessor(index, components, at)?;
        let kind = source.kind;
        if !matches!(kind, ComponentType::U8 | ComponentType::U16 | ComponentType::U32) {
            let message = format!(
                "has component type {}, expected unsigned integers (5121, 5123, 5125)",
                kind.as_gl_enum()
            );
            self.report.error("G0403", &format!("accessors[{index}]"), message);
            return None;
        }
        Some(source.collect(|bytes| number_u32(kind, bytes)))
    }

    /// Checks accessor `index` against its views.
    fn accessor(&mut self, index: usize, components: &[usize], at: &str) -> Option<Source> {
        if let Some(supplied) = self.accessors.supplied.get(&index).cloned() {
            self.check_width(index, supplied.components, components, at)?;
            return Some(Source::from(supplied));
        }
        let accessor: json::Accessor = self.doc.get(index, at, &mut self.report)?;
        let here = format!("accessors[{index}]");
        let (Checked::Valid(kind), Checked::Valid(shape)) = (accessor.component_type, accessor.type_) else {
            let message = "`componentType` or `type` is none that glTF knows";
            self.report.error("G0401", &here, message);
            return None;
        };
        let (kind, width) = (kind.0, shape.multiplicity());
        self.check_width(index, width, components, at)?;
        let count = accessor.count.0;
        let numbers = count.saturating_mul(width as u64);
        let base = match accessor.buffer_view {
            Some(view) => {
                let offset = accessor.byte_offset.unwrap_or_default().0;
                Some(self.strided(view.value(), offset, count, width, kind, &here)?)
            }
            None => {
                self.afford(Cost::Zeros, numbers, &here)?;
                None
            }
        };
        self.afford(Cost::Numbers, numbers, &here)?;
        let sparse = match &accessor.sparse {
            Some(sparse) => Some(self.sparse(sparse, count, width, kind, &format!("{here}.sparse"))?),
            None => None,
        };
        Some(Source {
            count: count as usize,
            components: width,
            kind,
            normalized: accessor.normalized,
            base,
            sparse,
        })
    }

    /// Refuses an accessor of `width` components where others are wanted.
    fn check_width(&mut self, index: usize, width: usize, wanted: &[usize], at: &str) -> Option<()> {
        if wanted.contains(&width) {
            return Some(());
        }
        let expected: Vec<String> = wanted.iter().map(usize::to_string).collect();
        let message = format!(
            "refers to accessor {index} with {width} components an element, expected {}",
            expected.join(" or ")
        );
        self.report.error("G0402", at, message);
        None
    }

    /// Elements in a view: refuses them unless the last one lies inside.
    fn strided(
        &mut self,
        view: usize,
        offset: u64,
        count: u64,
        width: usize,
        kind: ComponentType,
        at: &str,
    ) -> Option<Strided> {
        let element = (width * kind.size()) as u64;
        let view_data = self.view(view, &format!("{at}.bufferView"))?;
        let stride = view_data.stride.unwrap_or(element);
        if stride < element {
            let message =
                format!("the stride of bufferViews[{view}] is {stride}, less than an element of {element} bytes");
            self.report.error("G0404", at, message);
            return None;
        }
        let length = view_data.bytes.len() as u64;
        let last =
            (count.checked_sub(1)).and_then(|n| n.checked_mul(stride)?.checked_add(offset)?.checked_add(element));
        if count > 0 && last.is_none_or(|end| end > length) {
            let message = format!(
                "{count} elements of {element} bytes, {stride} apart, from byte {offset} on \
                 do not fit into bufferViews[{view}] of {length} bytes"
            );
            let d = Diagnostic::error("G0404", message);
            self.report
                .push(at, d.hint("the file is cut or damaged: copy or export it again"));
            return None;
        }
        Some(Strided {
            bytes: view_data.bytes,
            offset: offset.min(length) as usize,
            stride: stride as usize,
        })
    }

    /// The replacements of a sparse accessor.
    fn sparse(
        &mut self,
        sparse: &json::accessor::sparse::Sparse,
        count: u64,
        width: usize,
        kind: ComponentType,
        at: &str,
    ) -> Option<(Vec<u32>, Strided)> {
        let Checked::Valid(index_kind) = sparse.indices.component_type else {
            let place = format!("{at}.indices.componentType");
            self.report.error("G0401", &place, "is none of 5121, 5123, 5125");
            return None;
        };
        let (n, indices, values) = (sparse.count.0, &sparse.indices, &sparse.values);
        let place = format!("{at}.indices");
        let places = self.strided(
            indices.buffer_view.value(),
            indices.byte_offset.0,
            n,
            1,
            index_kind.0,
            &place,
        )?;
        let place = format!("{at}.values");
        let values = self.strided(values.buffer_view.value(), values.byte_offset.0, n, width, kind, &place)?;
        let source = Source {
            count: n as usize,
            components: 1,
            kind: index_kind.0,
            normalized: false,
            base: Some(places),
            sparse: None,
        };
        let targets = source.collect(|bytes| number_u32(index_kind.0, bytes));
        if let Some(bad) = targets.iter().find(|t| u64::from(**t) >= count) {
            let message = format!("replaces element {bad}, but the accessor has {count}");
            self.report.error("G0406", &format!("{at}.indices"), message);
            return None;
        }
        Some((targets, values))
    }
}

impl From<Supplied> for Source {
    fn from(supplied: Supplied) -> Source {
        let stride = supplied.components * supplied.kind.size();
        Source {
            count: supplied
                .bytes
                .len()
                .checked_div(stride)
                .unwrap_or(0)
                .min(supplied.count),
            components: supplied.components,
            kind: supplied.kind,
            normalized: supplied.normalized,
            base: Some(Strided {
                bytes: supplied.bytes,
                offset: 0,
                stride,
            }),
            sparse: None,
        }
    }
}

impl Source {
    /// All components in order, converted by `read`, which is given the bytes of one component.
    fn collect<T: Copy + Default>(&self, read: impl Fn(&[u8]) -> T) -> Vec<T> {
        let size = self.kind.size();
        let mut out = match &self.base {
            None => vec![T::default(); self.count * self.components],
            Some(base) => {
                let mut out = Vec::with_capacity(self.count * self.components);
                for i in 0..self.count {
                    out.extend(base.element(i, self.components * size).chunks_exact(size).map(&read));
                }
                out
            }
        };
        if let Some((targets, values)) = &self.sparse {
            for (i, target) in targets.iter().enumerate() {
                let from = values.element(i, self.components * size).chunks_exact(size);
                let to = *target as usize * self.components;
                for (slot, bytes) in out[to..to + self.components].iter_mut().zip(from) {
                    *slot = read(bytes);
                }
            }
        }
        out
    }
}

impl Strided {
    fn element(&self, i: usize, size: usize) -> &[u8] {
        let at = self.offset + i * self.stride;
        &self.bytes[at..at + size]
    }
}

/// A component as a number; normalised integers by the rule of the specification (3.6.2.2).
fn number(kind: ComponentType, normalized: bool, bytes: &[u8]) -> f32 {
    let (value, most) = match kind {
        ComponentType::F32 => return f32::from_le_bytes(le(bytes)),
        ComponentType::I8 => (f64::from(i8::from_le_bytes(le(bytes))), 127.0),
        ComponentType::I16 => (f64::from(i16::from_le_bytes(le(bytes))), 32767.0),
        ComponentType::U8 => (f64::from(number_u32(kind, bytes)), 255.0),
        ComponentType::U16 => (f64::from(number_u32(kind, bytes)), 65535.0),
        ComponentType::U32 => (f64::from(number_u32(kind, bytes)), f64::from(u32::MAX)),
    };
    if normalized {
        (value / most).max(-1.0) as f32
    } else {
        value as f32
    }
}

/// An unsigned component.
fn number_u32(kind: ComponentType, bytes: &[u8]) -> u32 {
    match kind {
        ComponentType::U8 => u32::from(le::<1>(bytes)[0]),
        ComponentType::U16 => u32::from(u16::from_le_bytes(le(bytes))),
        _ => u32::from_le_bytes(le(bytes)),
    }
}

/// The first N bytes; zeros where there are fewer, which cannot happen for checked elements.
fn le<const N: usize>(bytes: &[u8]) -> [u8; N] {
    std::array::from_fn(|i| bytes.get(i).copied().unwrap_or(0))
}
