#!/usr/bin/env python3
"""Declares the interface of the headers in other languages, out of the headers themselves.

usage: python3 declare.py python|csharp|abi <PREPROCESSED

PREPROCESSED is what `cc -E -DGXFEM_API=GXFEM_PUBLIC` makes of the headers (`make bindings` calls it so). python: ctypes, for
gxfem.py; csharp: P/Invoke; abi: functions, and members of structs with their places where pointers have 64 bits.

The headers' declarations are of few kinds: enumerations, structs, function pointers, functions. What else there is ends the
program with an error.
"""
import re
import sys

SCALARS = {  # C: size, ctypes, C#
    'char': (1, 'c_char', 'sbyte'), 'int': (4, 'c_int', 'int'), 'double': (8, 'c_double', 'double'), 'float': (4, 'c_float', 'float'),
    'int8_t': (1, 'c_int8', 'sbyte'), 'uint8_t': (1, 'c_uint8', 'byte'), 'int32_t': (4, 'c_int32', 'int'),
    'uint32_t': (4, 'c_uint32', 'uint'), 'int64_t': (8, 'c_int64', 'long'), 'uint64_t': (8, 'c_uint64', 'ulong'),
    'size_t': (8, 'c_size_t', 'UIntPtr'), 'unsigned': (4, 'c_uint', 'uint'),
}
CSHARP_WORDS = {'params', 'object', 'in', 'out', 'ref', 'base', 'string', 'fixed', 'event', 'lock', 'is', 'as', 'operator'}


class Type:
    """name: of a scalar, a struct or an enumeration, 'void', or 'function'; stars: how many pointers; dims: of an array; bits: of a
    bit-field, else 0"""

    def __init__(self, name, stars=0, dims=(), result=None, params=()):
        self.name, self.stars, self.dims, self.result, self.params = name, stars, tuple(dims), result, tuple(params)
        self.bits = 0

    def c(self, name=''):
        if self.name == 'function':
            inner = f'({"*" * self.stars}{name})'
            return f'{self.result.c()} {inner}({", ".join(t.c(n) for n, t in self.params) or "void"})'
        text = self.name + (' ' if name or self.stars else '') + '*' * self.stars + name
        return text + ''.join(f'[{d}]' for d in self.dims) + (f' : {self.bits}' if self.bits else '')


class Interface:
    def __init__(self, text):
        self.tokens = re.findall(r'[A-Za-z_]\w*|0[xX][0-9a-fA-F]+[uUlL]*|\d+[uUlL]*|<<|\S', text)
        self.at = 0
        self.enums = {}      # enumeration: its constants; the nameless ones under numbers
        self.constants = {}
        self.structs = {}    # struct: members (name, type); None: opaque
        self.aliases = {}
        self.functions = {}  # function: (result, parameters)
        self.order = []
        while self.at < len(self.tokens):
            self.declaration()

    def fail(self, why):
        sys.exit(f'declare.py: {why}: {" ".join(self.tokens[max(0, self.at - 8):self.at + 8])}')

    def peek(self, ahead=0):
        return self.tokens[self.at + ahead] if self.at + ahead < len(self.tokens) else ''

    def take(self, *wanted):
        token = self.peek()
        if wanted and token not in wanted:
            self.fail(f'{" or ".join(wanted)} should stand here')
        self.at += 1
        return token

    def declaration(self):
        token = self.take()
        if token == 'enum':
            self.enumeration(len(self.enums))
            self.take(';')
        elif token == 'typedef' and self.peek() == 'enum':
            self.take()
            name = self.take()
            self.enumeration(name)
            self.take(name)
            self.take(';')
        elif token == 'typedef' and self.peek() == 'struct':
            self.take()
            self.struct()
        elif token == 'typedef':
            name, kind = self.declarator(self.base())
            self.aliases[name] = kind
            self.order.append(('alias', name))
            self.take(';')
        elif token == 'GXFEM_PUBLIC':
            result = self.pointer(self.base())
            name = self.take()
            self.functions[name] = (result, self.parameters())
            self.take(';')
        else:
            self.at -= 1
            self.fail('neither an enumeration, a struct, an alias nor a public function')

    def enumeration(self, name):
        value, names = -1, []
        self.take('{')
        while self.peek() != '}':
            constant = self.take()
            value += 1
            if self.peek() == '=':
                self.take()
                value = int(self.take().rstrip('uUlL'), 0)
                if self.peek() == '<<':
                    self.take()
                    value <<= int(self.take().rstrip('uUlL'), 0)
            self.constants[constant] = value
            names.append(constant)
            if self.peek() == ',':
                self.take()
        self.take('}')
        self.enums[name] = names
        self.order.append(('enum', name))

    def struct(self):
        name, members = self.take(), []
        if self.peek() != '{':
            self.take(name)
            self.take(';')
            if name not in self.structs:
                self.structs[name] = None
                self.order.append(('struct', name))
            return
        self.take('{')
        while self.peek() != '}':
            base = self.base()
            members.append(self.declarator(base))
            while self.peek() == ',':
                self.take()
                members.append(self.declarator(base))
            self.take(';')
        self.take('}')
        self.take(name)
        self.take(';')
        self.structs[name] = members
        self.order.append(('struct', name))

    def base(self):
        if self.peek() == 'const':
            self.take()
        if self.peek() == 'struct':
            self.take()
        name = self.take()
        if name == 'unsigned' and self.peek() in ('char', 'int'):
            name = {'char': 'uint8_t', 'int': 'unsigned'}[self.take()]
        return Type(name)

    def pointer(self, base):
        stars = base.stars
        while self.peek() in ('*', 'const'):
            stars += self.take() == '*'
        return Type(base.name, stars)

    def declarator(self, base):
        kind = self.pointer(base)
        if self.peek() == '(':
            self.take()
            stars = 0
            while self.peek() == '*':
                self.take()
                stars += 1
            name = self.take()
            self.take(')')
            return name, Type('function', stars, (), kind, self.parameters())
        name = self.take() if re.match(r'[A-Za-z_]', self.peek()) else ''
        while self.peek() == '[':
            self.take()
            kind.dims += (int(self.take().rstrip('uUlL'), 0),)
            self.take(']')
        if self.peek() == ':':
            self.take()
            kind.bits = int(self.take())
        return name, kind

    def parameters(self):
        found = []
        self.take('(')
        if self.peek() == 'void' and self.peek(1) == ')':
            self.take()
        while self.peek() != ')':
            name, kind = self.declarator(self.base())
            if kind.dims:  # an array is passed as a pointer
                kind = Type(kind.name, kind.stars + 1, kind.dims[1:])
            found.append((name, kind))
            if self.peek() == ',':
                self.take()
        self.take(')')
        return found

    def resolve(self, kind):
        """the type behind an alias"""
        target = self.aliases.get(kind.name)
        if not target:
            return kind
        return self.resolve(Type(target.name, target.stars + kind.stars, kind.dims, target.result, target.params))


# ---- where members are

def layout(face, kind):
    """size and alignment"""
    kind = face.resolve(kind)
    if kind.stars or kind.name == 'function':
        size = align = 8
    elif kind.name in SCALARS:
        size = align = SCALARS[kind.name][0]
    elif kind.name in face.enums:
        size = align = 4
    else:
        places, size, align = struct_layout(face, kind.name)
    for d in kind.dims:
        size *= d
    return size, align


def struct_layout(face, name):
    places, at, most, used = [], 0, 1, 32  # used: bits of the last bit-field's number
    for member, kind in face.structs[name]:
        size, align = layout(face, kind)
        if kind.bits and used + kind.bits <= 8 * size:
            places.append(at - size)
            used += kind.bits
            continue
        at = -(-at // align) * align
        places.append(at)
        at += size
        most = max(most, align)
        used = kind.bits or 32
    return places, -(-at // most) * most, most


def write_abi(face):
    for kind, name in face.order:
        if kind == 'enum':
            print(f'enum {name if isinstance(name, str) else ""}'.rstrip())
            for constant in face.enums[name]:
                print(f'    {constant} = {face.constants[constant]}')
        elif kind == 'alias':
            print('typedef', face.aliases[name].c(name))
        elif face.structs[name] is None:
            print('struct', name)
        else:
            places, size, _ = struct_layout(face, name)
            print(f'struct {name}: {size} bytes')
            for place, (member, of) in zip(places, face.structs[name]):
                print(f'    {place:4} {of.c(member)}')
    for name, (result, params) in sorted(face.functions.items()):
        print(result.c(f'{name}') if result.stars else f'{result.c()} {name}', end='')
        print(f'({", ".join(t.c(n) for n, t in params)})')


# ---- ctypes

def ctypes_of(face, kind):
    target = face.resolve(kind)
    if target.name == 'function':
        text = f'CFUNCTYPE({", ".join(ctypes_of(face, t) for t in (target.result, *(t for _, t in target.params)))})'
        stars = target.stars - 1
    elif target.name == 'void':
        text, stars = ('c_void_p', target.stars - 1) if target.stars else ('None', 0)
    elif target.name == 'char' and target.stars:
        text, stars = 'c_char_p', target.stars - 1
    elif target.name in face.enums:
        text, stars = 'c_int', target.stars
    elif target.name not in SCALARS and target.name not in face.structs:  # private to the headers
        text, stars = 'c_void_p', target.stars - 1
    else:
        text, stars = SCALARS[target.name][1] if target.name in SCALARS else target.name, target.stars
    for _ in range(stars):
        text = f'POINTER({text})'
    for d in reversed(target.dims):
        text = f'{text} * {d}' if '*' not in text else f'({text}) * {d}'
    return text


def write_python(face):
    lines = []
    python_lines(face, lines.append)
    text = '\n'.join(lines)
    print('"""The interface of gxfem for ctypes. Written by `make bindings` from the headers; see gxfem.py."""')
    print('from ctypes import CFUNCTYPE, POINTER, Structure')
    print('from ctypes import', ', '.join(sorted(set(re.findall(r'\bc_\w+', text)))))
    print()
    print(text)


def python_lines(face, print):
    for constant, value in face.constants.items():
        print(f'{constant} = {value}')
    for name in face.structs:
        print(f'\n\nclass {name}(Structure):\n    pass')
    print('')
    for kind, name in face.order:
        if kind == 'alias':
            print(f'\n{name} = {ctypes_of(face, face.aliases[name])}')
        elif kind == 'struct' and face.structs[name] is not None:
            print(f'\n{name}._fields_ = [')
            for member, of in face.structs[name]:
                print(f'    ({member!r}, {ctypes_of(face, of)}{f", {of.bits}" if of.bits else ""}),')
            print(']')
    print('\n# function: result, parameters\nFUNCTIONS = {')
    for name, (result, params) in sorted(face.functions.items()):
        print(f'    {name!r}: ({ctypes_of(face, result)}, [{", ".join(ctypes_of(face, t) for _, t in params)}]),')
    print('}')


# ---- C#

def csharp_of(face, kind):
    target = face.resolve(kind)
    if target.stars or target.name == 'function':
        return 'IntPtr'
    if target.name in SCALARS:
        return SCALARS[target.name][2]
    return 'int' if target.name in face.enums and not isinstance(target.name, str) else target.name


def csharp_name(name):
    return '@' + name if name in CSHARP_WORDS else name


def write_csharp(face):
    print('// The interface of gxfem for C# (Unity and others), written by `make bindings` from the headers. Pointers are IntPtr; size_t is')
    print('// UIntPtr. The library is found by the name "gxfem". See docs/EMBEDDING.md.')
    print('using System;\nusing System.Runtime.InteropServices;\n\nnamespace Gxfem {')
    for kind, name in face.order:
        if kind == 'enum' and isinstance(name, str):
            print(f'    public enum {name} {{')
            for constant in face.enums[name]:
                print(f'        {constant} = {face.constants[constant]},')
            print('    }\n')
        elif kind == 'struct' and face.structs[name] is not None:
            print(f'    [StructLayout(LayoutKind.Sequential)]\n    public unsafe struct {name} {{')
            places = struct_layout(face, name)[0]
            for i, (member, of) in enumerate(face.structs[name]):
                if not of.bits:
                    write_csharp_member(face, csharp_name(member), of)
                elif i == 0 or places[i] != places[i - 1]:
                    print(f'        public {csharp_of(face, of)} bits{places[i]}; // from the lowest:', end=' ')
                    print(', '.join(n for (n, _), at in zip(face.structs[name], places) if at == places[i]))
            print('    }\n')
    print('    public static class Native {')
    for name, constants in face.enums.items():
        for constant in constants if not isinstance(name, str) else ():
            print(f'        public const uint {constant} = {face.constants[constant]};')
    for name, (result, params) in sorted(face.functions.items()):
        listed = ', '.join(f'{csharp_of(face, t)} {csharp_name(n)}' for n, t in params)
        print('\n        [DllImport("gxfem", CallingConvention = CallingConvention.Cdecl)]')
        print(f'        public static extern {csharp_of(face, result)} {name}({listed});')
    print('    }\n}')


def write_csharp_member(face, name, kind):
    target, count = face.resolve(kind), 1
    for d in target.dims:
        count *= d
    if not target.dims:
        print(f'        public {csharp_of(face, kind)} {name};')
    elif target.name in SCALARS and not target.stars:
        print(f'        public fixed {csharp_of(face, kind)} {name}[{count}];')
    else:  # C# has fixed arrays of numbers only
        print(f'        public {csharp_of(face, kind)} ' + ', '.join(f'{name}{i}' for i in range(count)) + ';')


def own_lines(text):
    """the lines of the headers, not of those that they include"""
    own, keep = [], False
    for line in text.splitlines():
        marker = re.match(r'#\s*(?:line\s+)?\d+\s+"([^"]*)"', line)
        if marker:
            keep = re.search(r'gxfem(_\w+)?\.h$', marker.group(1)) is not None
        elif keep and not line.lstrip().startswith('#'):
            own.append(line)
    return '\n'.join(own)


if __name__ == '__main__':
    writers = {'python': write_python, 'csharp': write_csharp, 'abi': write_abi}
    if len(sys.argv) != 2 or sys.argv[1] not in writers:
        sys.exit(__doc__)
    writers[sys.argv[1]](Interface(own_lines(sys.stdin.read())))
