"""Wrong arguments in one line: what was given, and what was probably meant."""
import difflib
import functools
import numbers
import operator
import os
import re
import textwrap


def _is_path(value):
    return isinstance(value, (str, os.PathLike))


def _is_whole(value):
    try:
        operator.index(value)
    except TypeError:
        return False
    return True


def _is_number(value):
    return isinstance(value, numbers.Real) or (hasattr(value, "__float__")
                                               and getattr(value, "ndim", 0) == 0
                                               and not isinstance(value, complex))


def _is_truth(value):
    return isinstance(value, (bool, int)) or type(value).__name__ in ("bool_", "bool")


def _is_sequence(each):
    """Whether a value is iterable, no text, and holds what `each` takes."""
    def holds(value):
        if isinstance(value, (str, bytes)) or not hasattr(value, "__iter__"):
            return False
        # An iterator is gone after a look.
        return iter(value) is value or all(each(one) for one in value)
    return holds


def _is_none(value):
    return value is None


def _either(*kinds):
    return lambda value: any(kind(value) for kind in kinds)


def _is_word(value):
    return _is_path(value) or _is_number(value) or _is_outgoing(value)


def _is_outgoing(value):
    return (isinstance(value, str) or _is_none(value) or _is_whole(value)
            or type(value).__name__ == "Outgoing" or _is_sequence(_is_number)(value))


def _is_brdf(value):
    """A BRDF; functions of Python have a message of their own."""
    return (_is_path(value) or callable(value) or hasattr(value, "brdf")
            or type(value).__name__ == "Brdf")


_PATH = (_is_path, "a string or a path")
_PATHS = (_either(_is_path, _is_sequence(_is_path)), "a string, a path or a sequence of them")
_BRDF = (_is_brdf, "a specification, a path or a BRDF")
_OUTGOING = (_is_outgoing, "'32x32', a number, (theta, phi) or an Outgoing")
_NAMES = (_either(_is_word, _is_none, _is_sequence(_is_word)), "a string or a sequence of them")
_PROGRESS = (_either(_is_none, callable), "a function progress(part, done, total)")
_LIGHTS = (_either(_is_path, _is_none, _is_sequence(_either(_is_path, _is_sequence(_is_number)))),
           "a light, or a sequence of them")

# A type of a signature to its test and its name in messages.
_KINDS = {
    "int": (_is_whole, "int"), "float": (_is_number, "float"), "bool": (_is_truth, "bool"),
    "str": (_either(_is_word, _is_none, _is_sequence(_is_word)), "str"), "Path": _PATH,
    "Names": _NAMES, "Progress": _PROGRESS, "OutgoingLike": _OUTGOING, "BrdfLike": _BRDF,
    "LightLike": _PATHS, "Union[Path, Sequence[Path]]": _PATHS, "Lights": _LIGHTS,
    "Sequence[str]": (_is_sequence(_is_path), "a sequence of strings"),
    "Numbers": (_either(_is_word, _is_none, _is_sequence(_is_number)), "a number or several"),
    "Union[int, Sequence[int]]":
        (_either(_is_whole, _is_none, _is_sequence(_is_whole)), "an int or a sequence of them"),
    "Union[float, Sequence[float]]":
        (_either(_is_number, _is_none, _is_sequence(_is_number)), "a float or a sequence of them"),
    "Rotation": (lambda value: type(value).__name__ == "Rotation", "a Rotation"),
    "Mapping[str, Any]": (lambda value: hasattr(value, "keys"), "a dict"),
}
# The same for arguments that a signature calls objects, by their names. Arrays are looked at where
# they are read.
_OBJECTS = {"path": _PATH, "folder": _PATH, "spec": _PATH, "brdf": _BRDF, "a": _BRDF, "b": _BRDF,
            "progress": _PROGRESS, "bases": _NAMES, "outgoing": _OUTGOING, "set": _OUTGOING,
            "name": (_either(_is_none, lambda value: isinstance(value, str)), "a string"),
            "f": (callable, "a function f(wi, wo) of wi (n, 3) and wo (3,) that returns (n,)")}


def _signature(doc, name):
    """(argument, kind, whether it has to be given) of the signature that begins a docstring, and
    how many may be given by place."""
    found = re.match(rf"{re.escape(name)}\((.*)\) ->", doc or "")
    if not found:
        return None, 0
    text, _, behind = found[1].partition("*, ")
    arguments = [re.findall(r"(?:^|, )(\w+): (.*?)(?=, \w+: |, $|$)", part)
                 for part in (text, behind)]
    return [(argument, kind.split(" = ")[0], " = " not in kind)
            for argument, kind in arguments[0] + arguments[1]], len(arguments[0])


def _test_of(argument, kind):
    """The test of a value and the name of its kind, or None; and whether None is a value."""
    optional = re.fullmatch(r"Optional\[(.*)\]", kind)
    if kind == "object":
        return _OBJECTS.get(argument), False
    return _KINDS.get(optional[1] if optional else kind), optional is not None


def _wrong(name, signature, given, named):
    """The first argument of a wrong type."""
    values = dict(zip((argument for argument, _, _ in signature), given)) | named
    for argument, kind, _ in signature:
        if argument not in values:
            continue
        test, optional = _test_of(argument, kind)
        value = values[argument]
        if test and not (optional and value is None) and not test[0](value):
            return f"{name}(): {argument} is {_shown(value)}, expected {test[1]}"
    return None


def _shown(value):
    return " ".join(f"{value!r:.60}".split())


def _reason(name, signature, places, given, named):
    """The first mistake among the arguments, as far as the signature tells."""
    known = [argument for argument, _, _ in signature]
    own = [argument for argument in known if argument != "self"]
    if len(given) > places:
        shown = [argument for argument in known[:places] if argument != "self"]
        return f"{name}() takes {len(shown)} by place ({', '.join(shown)}); name the others"
    for word in named:
        if word not in known:
            near = ([argument for argument in own if argument.startswith(word)]
                    or difflib.get_close_matches(word, own, 1))
            hint = f" (did you mean '{near[0]}'?)" if near else f"; it takes {', '.join(own)}"
            return f"{name}() has no argument '{word}'{hint}"
    values = dict(zip(known, given)) | named
    for argument, _, needed in signature:
        if needed and argument not in values:
            return f"{name}(): {argument} is missing"
    wrong = _wrong(name, signature, given, named)
    if wrong:
        return wrong
    shown = [f"{argument}={_shown(value)}" for argument, value in values.items()
             if argument != "self"]
    return f"{name}(): no value of the right type among {', '.join(shown)}"


def _explained(function, name, shown=None, method=False):
    """`shown`: the name in messages, of a method with underscores. The values of a call are looked
    at first, but those of __call__, which may be called often, only where it failed."""
    signature, places = _signature(function.__doc__, name)
    if signature is None:
        return function
    if method and not (signature and signature[0][0] == "self"):
        signature, places = [("self", "object", False)] + signature, places + 1

    # The first line is the signature.
    head, *lines = function.__doc__.split("\n")
    folded = [textwrap.fill(line, 99, subsequent_indent=" " * 12) if len(line) > 99 else line
              for line in lines]

    @functools.wraps(function)
    def call(*given, **named):
        reason = None if name == "__call__" else _wrong(shown or name, signature, given, named)
        if reason is None:
            try:
                return function(*given, **named)
            except TypeError as error:
                if "incompatible " not in str(error):
                    raise
                reason = _reason(shown or name, signature, places, given, named)
        raise TypeError(reason)

    call.__doc__ = "\n".join([head, *folded])
    return call


def attach(module, names):
    """Gives the functions of a module, and the methods of its classes, such messages."""
    for name in names:
        found = module[name]
        if not isinstance(found, type):
            module[name] = _explained(found, name)
            continue
        for method, member in list(vars(found).items()):
            own = type(member).__name__ == "instancemethod"
            if method in ("__init__", "__call__") and own:
                setattr(found, method, _explained(member, method, name, True))
            elif isinstance(member, staticmethod):
                setattr(found, method, staticmethod(_explained(member.__func__, method)))
            elif not method.startswith("_") and own:
                setattr(found, method, _explained(member, method, None, True))
