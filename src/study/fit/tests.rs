use super::super::synthetic;
use super::*;
