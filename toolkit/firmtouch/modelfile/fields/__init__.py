"""The kinds of entry that a model file has, as pydantic types: names, quantities, expressions, poles."""

from firmtouch.modelfile.fields.checked import Checked, declared, problems_of, read_all, refuse, under
from firmtouch.modelfile.fields.constant import POSITIVE, Range, constant_in, read_constant, value_of, values_of
from firmtouch.modelfile.fields.formula import EXPRESSION_SCHEMA, Expression, expression_in, read_expression
from firmtouch.modelfile.fields.frequency import frequency_between
from firmtouch.modelfile.fields.names import Label, NewName, Text, check_keys, new_name
from firmtouch.modelfile.fields.pole import read_pole
from firmtouch.modelfile.fields.quantity import (
    QUANTITY_SCHEMA,
    AnyQuantity,
    Quantity,
    UnitText,
    expect_dimension,
    quantity_in,
    read_quantities,
    read_quantity,
)

__all__ = [
    "EXPRESSION_SCHEMA",
    "POSITIVE",
    "QUANTITY_SCHEMA",
    "AnyQuantity",
    "Checked",
    "Expression",
    "Label",
    "NewName",
    "Quantity",
    "Range",
    "Text",
    "UnitText",
    "check_keys",
    "constant_in",
    "declared",
    "expect_dimension",
    "expression_in",
    "frequency_between",
    "new_name",
    "problems_of",
    "quantity_in",
    "read_all",
    "read_constant",
    "read_expression",
    "read_pole",
    "read_quantities",
    "read_quantity",
    "refuse",
    "under",
    "value_of",
    "values_of",
]
