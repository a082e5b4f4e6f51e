"""Wrong arguments in one line: what was given, and what was probably meant."""
import difflib
import functools
import re
import textwrap

_KINDS = {"int": int, "float": (int, float), "bool": bool, "str": str}


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
    for argument, kind, needed in signature:
        if needed and argument not in values:
            return f"{name}(): {argument} is missing"
        expected = _KINDS.get(kind)
        if expected and argument in values and not isinstance(values[argument], expected):
            return f"{name}(): {argument} is {values[argument]!r:.60}, expected {kind}"
    return None


def _explained(function, name):
    signature, places = _signature(function.__doc__, name)
    if signature is None:
        return function

    # The first line is the signature.
    head, *lines = function.__doc__.split("\n")
    folded = [textwrap.fill(line, 99, subsequent_indent=" " * 12) if len(line) > 99 else line
              for line in lines]

    @functools.wraps(function)
    def call(*given, **named):
        try:
            return function(*given, **named)
        except TypeError as error:
            if "incompatible function arguments" not in str(error):
                raise
            reason = _reason(name, signature, places, given, named)
            if reason is None:
                raise
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
            if not method.startswith("_") and type(member).__name__ == "instancemethod":
                setattr(found, method, _explained(member, method))
