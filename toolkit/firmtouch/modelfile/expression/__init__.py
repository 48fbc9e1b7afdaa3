"""Expressions of a model file: a grammar of our own, a small tree, and readings of that tree.

The text never reaches `eval`, `sympify` or any other interpreter. `parse` makes the tree, `kind_of` finds its
dimension and size, `evaluate` reads it with any arithmetic: floats, CasADi, SymPy.
"""

from firmtouch.modelfile.expression.evaluate import Value, evaluate
from firmtouch.modelfile.expression.functions import CONSTANTS, FUNCTIONS
from firmtouch.modelfile.expression.kind import Kind, kind_of
from firmtouch.modelfile.expression.parse import parse
from firmtouch.modelfile.expression.problem import ExpressionError, Problem
from firmtouch.modelfile.expression.tree import (
    Call,
    Name,
    Node,
    Number,
    Power,
    Product,
    Rate,
    Sum,
    Vector,
    names_in,
    size,
)

__all__ = [
    "CONSTANTS",
    "FUNCTIONS",
    "Call",
    "ExpressionError",
    "Kind",
    "Name",
    "Node",
    "Number",
    "Power",
    "Problem",
    "Product",
    "Rate",
    "Sum",
    "Value",
    "Vector",
    "evaluate",
    "kind_of",
    "names_in",
    "parse",
    "size",
]
