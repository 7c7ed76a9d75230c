"""Translation of pure Python functions to JavaScript, so that a page uses the same arithmetic.

The functions must consist of plain arithmetic: assignments, loops, conditions, comprehensions, and calls of ``math``,
of some builtins and of each other. Anything else raises a ``SyntaxError`` that quotes it. The functions and constants
that they use are translated, too.
"""

import ast
import inspect
import json
import math
import textwrap
from collections.abc import Callable, Iterable
from types import ModuleType
from typing import Any

from walkerlab.text.escape import printable

BUILTINS = {"enumerate", "len", "list", "max", "min", "reversed", "sum", "zip"}
"""Functions that ``python.js`` defines in the object ``py``."""

OPERATORS: dict[type[ast.AST], str] = {
    ast.Add: "+", ast.Sub: "-", ast.Mult: "*", ast.Div: "/", ast.Pow: "**", ast.USub: "-", ast.UAdd: "+",
    ast.Lt: "<", ast.LtE: "<=", ast.Gt: ">", ast.GtE: ">=", ast.Eq: "===", ast.NotEq: "!==", ast.Is: "===",
    ast.IsNot: "!==", ast.And: "&&", ast.Or: "||", ast.Not: "!",
}  # fmt: skip


def translate(functions: Iterable[Callable[..., Any]]) -> str:
    """Return JavaScript that defines these functions, and the functions and constants that they use.

    Raises:
        SyntaxError: If a function contains something that is not supported.
    """
    definitions: dict[str, str] = {}
    for function in functions:
        _define(function.__name__, function, definitions)
    return "\n".join(definitions.values())


def _define(name: str, value: Any, definitions: dict[str, str]) -> None:
    """Add the definition of a function or constant, after those that it uses."""
    if name in definitions:
        return
    if not inspect.isfunction(value):
        definitions[name] = f"const {name} = {json.dumps(value)};"
        return
    definitions[name] = ""  # prevents a second definition of a recursive function
    tree = ast.parse(textwrap.dedent(inspect.getsource(value))).body[0]
    assert isinstance(tree, ast.FunctionDef)
    translator = _Translator(value.__globals__)
    text = translator.function(tree)
    for used, object_used in translator.globals_used.items():
        _define(used, object_used, definitions)
    del definitions[name]
    definitions[name] = text


class _Translator:
    """Translator of one function.

    Attributes:
        globals_used: Global functions and constants that the function uses, except builtins and modules.
    """

    def __init__(self, scope: dict[str, Any]) -> None:
        self._scope = scope
        self._local: set[str] = set()
        self.globals_used: dict[str, Any] = {}

    def function(self, tree: ast.FunctionDef) -> str:
        self._local = {argument.arg for argument in tree.args.args}
        arguments = ", ".join(argument.arg for argument in tree.args.args)
        body = tree.body[1:] if ast.get_docstring(tree) else tree.body
        statements = self._block(body)
        new = sorted(self._local - {argument.arg for argument in tree.args.args})
        declarations = f"let {', '.join(new)};\n" if new else ""
        return f"function {tree.name}({arguments}) {{\n{declarations}{statements}\n}}"

    # ---------------------------------------------------------------------------------------------- statements

    def _block(self, statements: list[ast.stmt]) -> str:
        return "\n".join(map(self._statement, statements))

    def _statement(self, node: ast.stmt) -> str:
        match node:
            case ast.Return(value=value):
                return f"return {self._value(value) if value else ''};"
            case ast.Expr(value=ast.Call() as value):
                return f"{self._value(value)};"
            case ast.Assign(targets=[target], value=value):
                return self._assign(target, self._value(value))
            case ast.AugAssign(target=ast.Name() as target, op=op, value=value):
                return f"{target.id} {self._operator(op)}= {self._value(value)};"
            case ast.If(test=test, body=body, orelse=orelse):
                otherwise = f" else {{\n{self._block(orelse)}\n}}" if orelse else ""
                return f"if ({self._value(test)}) {{\n{self._block(body)}\n}}{otherwise}"
            case ast.For(target=ast.Name(id="_"), iter=iterable, body=body, orelse=[]):
                return f"for (const _ of {self._value(iterable)}) {{\n{self._block(body)}\n}}"
            case ast.For(target=target, iter=iterable, body=body, orelse=[]):
                names = self._target(target)
                return f"for ({names} of {self._value(iterable)}) {{\n{self._block(body)}\n}}"
            case _:
                raise _unsupported(node)

    def _assign(self, target: ast.expr, value: str) -> str:
        match target:
            case ast.Attribute(value=owner, attr=name):
                return f"py.assign({self._value(owner)}, {json.dumps(name)}, {value});"
            case ast.Subscript(value=owner, slice=ast.Constant(value=int(index))) if index >= 0:
                return f"{self._value(owner)}[{index}] = {value};"
            case ast.Tuple():
                return f"[{', '.join(self._names(target))}] = {value};"
            case _:
                return f"{self._target(target)} = {value};"

    def _target(self, node: ast.expr) -> str:
        names = self._names(node)
        return names[0] if isinstance(node, ast.Name) else f"[{', '.join(names)}]"

    def _names(self, node: ast.expr) -> list[str]:
        items = node.elts if isinstance(node, ast.Tuple) else [node]
        names = [item.id for item in items if isinstance(item, ast.Name)]
        if len(names) != len(items):
            raise _unsupported(node)
        self._local.update(names)
        return names

    # --------------------------------------------------------------------------------------------- expressions

    def _value(self, node: ast.expr) -> str:
        match node:
            case ast.Constant(value=value):
                return json.dumps(value)
            case ast.Name(id=name):
                return self._name(node, name)
            case ast.Attribute(value=ast.Name(id="math"), attr=name):
                value = getattr(math, name)
                return repr(value) if isinstance(value, float) else f"Math.{name}"
            case ast.Attribute(value=owner, attr=name):
                return f"{self._value(owner)}.{name}"
            case ast.Subscript(value=owner, slice=ast.Slice()):
                raise _unsupported(node)
            case ast.Subscript(value=owner, slice=index):
                return f"py.item({self._value(owner)}, {self._value(index)})"
            case ast.BinOp(left=left, op=ast.FloorDiv(), right=right):
                return f"Math.floor({self._value(left)} / {self._value(right)})"
            case ast.BinOp(left=left, op=op, right=right):
                return f"({self._value(left)} {self._operator(op)} {self._value(right)})"
            case ast.UnaryOp(op=op, operand=operand):
                return f"({self._operator(op)}{self._value(operand)})"
            case ast.BoolOp(op=op, values=values):
                return f"({f' {self._operator(op)} '.join(map(self._value, values))})"
            case ast.Compare(left=left, ops=[op], comparators=[right]):
                return f"({self._value(left)} {self._operator(op)} {self._value(right)})"
            case ast.IfExp(test=test, body=body, orelse=orelse):
                return f"({self._value(test)} ? {self._value(body)} : {self._value(orelse)})"
            case ast.Tuple(elts=items) | ast.List(elts=items):
                return f"[{', '.join(map(self._value, items))}]"
            case ast.Starred(value=value):
                return f"...{self._value(value)}"
            case ast.JoinedStr(values=values):
                return " + ".join(['""', *map(self._value, values)])
            case ast.FormattedValue(value=value, conversion=-1, format_spec=None):
                return f"String({self._value(value)})"
            case (
                ast.GeneratorExp(elt=element, generators=[generator])
                | ast.ListComp(elt=element, generators=[generator])
            ):
                return self._comprehension(element, generator)
            case ast.Call(func=function, args=arguments, keywords=keywords):
                return self._call(function, arguments, keywords)
            case _:
                raise _unsupported(node)

    def _name(self, node: ast.expr, name: str) -> str:
        if name in self._local:
            return name
        if name in BUILTINS:
            return f"py.{name}"
        value = self._scope.get(name)
        if value is None or isinstance(value, ModuleType | type):
            raise _unsupported(node)
        self.globals_used[name] = value
        return name

    def _comprehension(self, element: ast.expr, generator: ast.comprehension) -> str:
        known = set(self._local)
        names = self._target(generator.target)
        tests = " && ".join(map(self._value, generator.ifs)) or "true"
        text = f"py.list({self._value(generator.iter)}).flatMap(({names}) => {tests} ? [{self._value(element)}] : [])"
        self._local = known
        return text

    def _call(self, function: ast.expr, arguments: list[ast.expr], keywords: list[ast.keyword]) -> str:
        # The only keywords are "start" and "strict", which has no effect on lists of equal length; both come last.
        values = [self._value(argument) for argument in arguments]
        values += [self._value(keyword.value) for keyword in keywords if keyword.arg == "start"]
        if any(keyword.arg not in ("start", "strict") for keyword in keywords):
            raise _unsupported(function)
        if isinstance(function, ast.Name) and function.id == "range":
            return f"py.range({', '.join(values)})"
        return f"{self._value(function)}({', '.join(values)})"

    def _operator(self, node: ast.AST) -> str:
        if type(node) not in OPERATORS:
            raise _unsupported(node)
        return OPERATORS[type(node)]


def _unsupported(node: ast.AST) -> SyntaxError:
    return SyntaxError(f"cannot translate to JavaScript: {printable(ast.unparse(node))}")
