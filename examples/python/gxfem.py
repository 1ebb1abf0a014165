"""gxfem in Python: bodies that are cut, and Booleans of surfaces, with numpy arrays.

    import gxfem
    body = gxfem.Body(positions, tetrahedra, young=1e5)

Put this folder on the path. The library, which `make lib` builds, is found beside this file, in build/ of the project, or where
GXFEM_LIBRARY says. gxfem_declarations.py declares all of its functions and structs for ctypes; `gxfem.native` has both, for what the
classes here leave out. Names, units and rules are those of gxfem.h.

Arrays that a body shows (view, skin) are the body's own memory: nothing is copied, and writing displacement or velocity changes the
body. They keep the body alive. They are valid until the next cut, carving, restore or skin, as in C; then the next view or skin has
new ones. Arrays given to a call are not copied if they are of the right type and contiguous.
"""
import ctypes
import os
import sys

import numpy

import gxfem_declarations as native

__all__ = ['Body', 'Blade', 'Boolean', 'Error', 'native', 'half_space', 'box', 'sphere']


def _open():
    here = os.path.dirname(os.path.abspath(__file__))
    name = {'win32': 'gxfem.dll', 'darwin': 'libgxfem.dylib'}.get(sys.platform, 'libgxfem.so')
    places = [os.environ.get('GXFEM_LIBRARY'), os.path.join(here, name), os.path.join(here, '..', '..', 'build', name)]
    for place in places:
        if place and os.path.exists(place):
            return ctypes.CDLL(place)
    raise ImportError(f'gxfem: {name} is neither beside gxfem.py nor in build/ (make lib); GXFEM_LIBRARY can name it')


_library = _open()
for _name, (_result, _parameters) in native.FUNCTIONS.items():
    _function = getattr(_library, _name)
    _function.restype, _function.argtypes = _result, _parameters
    setattr(native, _name, _function)


class Error(Exception):
    """What a call was refused for: result (native.GX_ERROR_...), field, index and surface, None where there is none"""

    def __init__(self, result, failure):
        none = ctypes.c_size_t(-1).value
        self.result = result
        self.field = failure.field.decode() if failure.field else None
        self.index = None if failure.index == none else failure.index
        self.surface = None if failure.surface == none else failure.surface
        where = ''.join((f' {self.index}' if self.index is not None else '', f' of surface {self.surface}' if self.surface is not None else ''))
        super().__init__(f'{self.field or "the call"}{where}: {native.gx_result_text(result).decode()}')


def _call(function, *arguments):
    failure = native.gx_failure()
    result = function(*arguments, ctypes.byref(failure))
    if result != native.GX_OK:
        raise Error(result, failure)


def _array(values, dtype, columns=None):
    """a contiguous array of a type, rows of so many columns; no copy if it is one already"""
    array = numpy.ascontiguousarray(values, dtype=dtype)
    if columns and (array.ndim != 2 or array.shape[1] != columns):
        raise ValueError(f'rows of {columns} numbers are needed, not an array of shape {array.shape}')
    return array


def _pointer(array, of):
    return array.ctypes.data_as(ctypes.POINTER(of)) if array is not None and array.size else None


def _doubles(array):
    return _pointer(array, ctypes.c_double)


def _indices(array):
    return _pointer(array, ctypes.c_uint32)


def _shown(pointer, shape, owner, writable=False):
    """memory of the library as an array, which keeps the owner alive; None where there is none"""
    if not pointer and numpy.prod(shape) > 0:
        return None
    count = int(numpy.prod(shape))
    scalar = pointer._type_
    memory = (scalar * count).from_address(ctypes.addressof(pointer.contents)) if count else (scalar * 0)()
    memory._owner = owner
    array = numpy.frombuffer(memory, dtype=scalar).reshape(shape)
    array.flags.writeable = writable
    return array


class _Shown:
    """arrays and numbers under the names that the C struct has"""

    def __init__(self, **values):
        self.__dict__.update(values)


def _surface(mesh, kind, keep):
    """(vertices, triangles) as a gx_surface; keep: a list that holds what it points to"""
    vertices, triangles = _array(mesh[0], numpy.float64, 3), _array(mesh[1], numpy.uint32, 3)
    keep += [vertices, triangles]
    return native.gx_surface(vertices=_doubles(vertices), vertex_count=len(vertices), triangles=_indices(triangles),
                             triangle_count=len(triangles), kind=kind)


def _numbers(struct):
    """what a report says, as a dictionary"""
    return {name: getattr(struct, name) for name, *_ in struct._fields_ if isinstance(getattr(struct, name), (int, float))}


def half_space(axis, side, value):
    """what lies below (side -1) or above (+1) a value along an axis, for hold"""
    return native.gx_region_half_space(axis, side, value)


def box(low, high):
    return native.gx_region_box((ctypes.c_double * 3)(*low), (ctypes.c_double * 3)(*high))


def sphere(center, radius):
    return native.gx_region_sphere((ctypes.c_double * 3)(*center), radius)


class Body:
    """A deformable body of tetrahedra. positions: n x 3, m; tetrahedra: m x 4. Further arguments: members of gx_body_desc, as
    young (Pa), poisson, density (kg/m3), support_below."""

    _skin_vertices = 0

    def __init__(self, positions, tetrahedra, **desc):
        positions, tetrahedra = _array(positions, numpy.float64, 3), _array(tetrahedra, numpy.uint32, 4)
        made = native.gx_body_desc(positions=_doubles(positions), node_count=len(positions), elements=_indices(tetrahedra),
                                   element_count=len(tetrahedra), young=1e5, poisson=0.3, density=1000)
        for name, value in desc.items():
            _set(made, name, value)
        self._body = ctypes.POINTER(native.gx_body)()
        _call(native.gx_body_create, ctypes.byref(made), ctypes.byref(self._body))

    @classmethod
    def _of(cls, pointer):
        body = cls.__new__(cls)
        body._body = pointer
        return body

    @classmethod
    def load(cls, data):
        """a body out of the bytes of save"""
        pointer = ctypes.POINTER(native.gx_body)()
        _call(native.gx_body_load, data, len(data), None, ctypes.byref(pointer))
        return cls._of(pointer)

    def __del__(self):
        if getattr(self, '_body', None):
            native.gx_body_destroy(self._body)
            self._body = None

    def save(self):
        size = ctypes.c_size_t()
        _call(native.gx_body_save, self._body, None, 0, ctypes.byref(size))
        data = ctypes.create_string_buffer(size.value)
        _call(native.gx_body_save, self._body, data, size, ctypes.byref(size))
        return data.raw

    def clone(self):
        pointer = ctypes.POINTER(native.gx_body)()
        _call(native.gx_body_clone, self._body, ctypes.byref(pointer))
        return Body._of(pointer)

    def restore(self, other):
        """becomes what another body is, as a clone made before"""
        _call(native.gx_body_restore, self._body, other._body)

    def hold(self, *regions):
        """holds what is in the regions now, and after later cuts; none: releases all"""
        _call(native.gx_body_hold, self._body, (native.gx_region * max(1, len(regions)))(*regions), len(regions))

    def cut(self, *sheets, solids=(), keeps=(), fragments=()):
        """Cuts by open or closed sheets, and removes what is in closed solids, or outside of those that keep, all at once. Each:
        (vertices n x 3, triangles m x 3).
        fragments: those that alone are cut. Returns the report's numbers."""
        keep = []
        kinds = (native.GX_SURFACE_SHEET, sheets), (native.GX_SURFACE_SOLID, solids), (native.GX_SURFACE_KEEP, keeps)
        surfaces = [_surface(s, kind, keep) for kind, given in kinds for s in given]
        scope = _array(fragments, numpy.uint32)
        desc = native.gx_cut_desc(surfaces=(native.gx_surface * max(1, len(surfaces)))(*surfaces), surface_count=len(surfaces),
                                  scope_fragments=_indices(scope), scope_fragment_count=len(scope))
        report = native.gx_cut_report()
        _call(native.gx_body_cut, self._body, ctypes.byref(desc), ctypes.byref(report))
        return _numbers(report)

    def carve(self, tool):
        """removes what a closed tool in space covers now"""
        keep, report = [], native.gx_cut_report()
        _call(native.gx_body_carve, self._body, ctypes.byref(_surface(tool, native.GX_SURFACE_SOLID, keep)), ctypes.byref(report))
        return _numbers(report)

    def contact(self, on=True, **desc):
        """lets the pieces press on each other in later steps, or not. Further arguments: members of gx_contact_desc, as friction"""
        _call(native.gx_body_contact, self._body, ctypes.byref(native.gx_contact_desc(**desc)) if on else None)

    def _step_desc(self, keep, desc):
        """a gx_step_desc; keep: a list that holds what it points to"""
        made = native.gx_step_desc()
        for name, value in desc.items():
            if name in ('forces', 'targets'):
                value = _array(value, numpy.float64, 3)
                if len(value) != self.view().copy_count:
                    raise ValueError(f'{name}: as many rows as there are copies are needed')
                keep.append(value)
                made.epoch = self.view().epoch
                value = _doubles(value)
            _set(made, name, value)
        return made

    def step(self, dt, **desc):
        """A time step. Further arguments: members of gx_step_desc: gravity, integrator, newton_iterations; forces and targets are
        arrays of three numbers for each copy. Returns the report's numbers."""
        report, keep = native.gx_step_report(), []
        _call(native.gx_body_step, self._body, ctypes.byref(self._step_desc(keep, {'dt': dt, **desc})), ctypes.byref(report))
        return _numbers(report)

    def view(self):
        """cells, copies and fragments as they are; displacement, velocity and rest_time may be written"""
        v = native.gx_view()
        _call(native.gx_body_view, self._body, ctypes.byref(v))
        cells, copies, pieces = v.cell_count, v.copy_count, v.fragment_count
        shapes = {'cell_element': cells, 'cell_copies': (cells, 4), 'cell_volume': cells, 'cell_fragment': cells, 'cell_slot': cells,
                  'slot_parent': v.slot_count, 'copy_node': copies, 'copy_held': copies, 'copy_region': copies,
                  'displacement': (copies, 3), 'velocity': (copies, 3), 'rest_time': copies, 'fragment_volume': pieces,
                  'fragment_mass': pieces, 'fragment_center': (pieces, 3), 'fragment_inertia': (pieces, 6), 'fragment_id': pieces,
                  'fragment_origin': pieces, 'fragment_change': pieces, 'removed_ids': v.removed_count}
        arrays = {name: _shown(getattr(v, name), shape, self, name in ('displacement', 'velocity', 'rest_time'))
                  for name, shape in shapes.items()}
        return _Shown(**_numbers(v), **arrays)

    def skin(self, crease_angle=0, smooth_cuts=0):
        """the surface to be drawn: triangles, and for each of them fragment, element, material and the surface that cut it"""
        desc, s = native.gx_skin_desc(crease_angle=crease_angle, smooth_cuts=smooth_cuts), native.gx_skin()
        _call(native.gx_body_skin, self._body, ctypes.byref(desc), ctypes.byref(s))
        vertices, triangles = s.vertex_count, s.triangle_count
        self._skin_vertices = vertices
        shapes = {'vertex_point': vertices, 'vertex_rest': (vertices, 3), 'vertex_normal': (vertices, 3), 'triangles': (triangles, 3),
                  'triangle_fragment': triangles, 'triangle_element': triangles, 'triangle_material': triangles,
                  'triangle_surface': triangles}
        return _Shown(**_numbers(s), **{name: _shown(getattr(s, name), shape, self) for name, shape in shapes.items()})

    def positions(self):
        """where the vertices of the latest skin are now, n x 3, m"""
        positions = numpy.empty((self._skin_vertices, 3))
        _call(native.gx_body_skin_positions, self._body, _doubles(positions))
        return positions

    def motions(self):
        """how fragments move: a list of gx_motion"""
        motions = (native.gx_motion * max(1, self.view().fragment_count))()
        _call(native.gx_body_motion, self._body, motions, len(motions))
        return list(motions)

    def pick(self, origin, direction):
        """the nearest triangle of the skin on a ray, as gx_hit; None if there is none"""
        hit = native.gx_hit()
        _call(native.gx_body_pick, self._body, (ctypes.c_double * 3)(*origin), (ctypes.c_double * 3)(*direction), ctypes.byref(hit))
        return hit if hit.copy_count else None

    def locate(self, points):
        """the material at points of space: a list of gx_hit"""
        points = _array(points, numpy.float64, 3)
        hits = (native.gx_hit * max(1, len(points)))()
        _call(native.gx_body_locate, self._body, _doubles(points), len(points), hits)
        return list(hits)[:len(points)]

    def blade(self, **desc):
        return Blade(self, **desc)

    def topology_hash(self):
        return native.gx_body_topology_hash(self._body, None)


class Group:
    """Bodies that touch each other, in steps of all of them. Each has contact on, and may be cut, drawn and saved as if alone."""

    def __init__(self, *bodies):
        self._bodies = bodies
        self._group = ctypes.POINTER(native.gx_group)()
        pointers = (ctypes.POINTER(native.gx_body) * len(bodies))(*(body._body for body in bodies))
        _call(native.gx_group_create, pointers, len(bodies), ctypes.byref(self._group))

    def __del__(self):
        if getattr(self, '_group', None):
            native.gx_group_destroy(self._group)
            self._group = None

    def step(self, dt, loads=(), **desc):
        """A time step of all. Further arguments: as of Body.step, for all. loads: for each body, in order, a dictionary of what acts
        on it, as forces. Returns the report's numbers."""
        report, keep = native.gx_step_report(), []
        own = [dict(load) for load in loads] + [{}] * (len(self._bodies) - len(loads))
        own[0] = {'dt': dt, **desc, **own[0]}
        steps = (native.gx_step_desc * len(own))(*(body._step_desc(keep, load) for body, load in zip(self._bodies, own)))
        _call(native.gx_group_step, self._group, steps, ctypes.byref(report))
        return _numbers(report)

    def contacts(self):
        """where bodies, or pieces of one, pressed on each other in the last step: a list of gx_group_contact"""
        count, failure = ctypes.c_size_t(), native.gx_failure()
        native.gx_group_contacts(self._group, None, 0, ctypes.byref(count), ctypes.byref(failure))
        found = (native.gx_group_contact * max(1, count.value))()
        _call(native.gx_group_contacts, self._group, found, count, ctypes.byref(count))
        return list(found[:count.value])


class Blade:
    """An edge in space that cuts the body while it moves. Arguments: members of gx_blade_desc."""

    def __init__(self, body, **desc):
        self._body = body  # which owns it
        self._blade = ctypes.POINTER(native.gx_blade)()
        _call(native.gx_blade_create, body._body, ctypes.byref(native.gx_blade_desc(**desc)), ctypes.byref(self._blade))

    def move(self, edge, fragments=()):
        """moves the edge, a polyline n x 3; returns the report's numbers, those of the cut included"""
        edge, scope, report = _array(edge, numpy.float64, 3), _array(fragments, numpy.uint32), native.gx_blade_report()
        _call(native.gx_blade_move, self._blade, _doubles(edge), len(edge), _indices(scope), len(scope), ctypes.byref(report))
        return {**_numbers(report), **_numbers(report.cut)}

    def lift(self):
        report = native.gx_blade_report()
        _call(native.gx_blade_lift, self._blade, ctypes.byref(report))
        return {**_numbers(report), **_numbers(report.cut)}


class Boolean:
    """Booleans of closed surfaces: operands are added one by one, and evaluate gives the result of all so far."""

    UNION, INTERSECTION, DIFFERENCE, SYMMETRIC_DIFFERENCE, SPLIT = range(5)

    def __init__(self, fine=False, mend=False, triangulation=native.GXB_DIVIDED, retained=False):
        self._boolean = ctypes.POINTER(native.gxb_boolean)()
        _call(native.gxb_boolean_create, None, ctypes.byref(self._boolean))
        _call(native.gxb_boolean_set_triangulation, self._boolean, triangulation)
        _call(native.gxb_boolean_set_fine, self._boolean, fine)
        _call(native.gxb_boolean_set_mend, self._boolean, mend)
        _call(native.gxb_boolean_set_retained, self._boolean, retained)

    def __del__(self):
        if getattr(self, '_boolean', None):
            native.gxb_boolean_destroy(self._boolean)
            self._boolean = None

    def add(self, vertices, triangles, operation=UNION, rule=native.GXB_NONZERO, simple=False):
        """adds a surface, which is copied; returns the Boolean"""
        vertices, triangles = _array(vertices, numpy.float64, 3), _array(triangles, numpy.uint32, 3)
        operand = native.gxb_operand(vertices=_doubles(vertices), vertex_count=len(vertices), triangles=_indices(triangles),
                                     triangle_count=len(triangles), operation=operation, rule=rule, simple=simple)
        _call(native.gxb_boolean_add, self._boolean, ctypes.byref(operand))
        return self

    def evaluate(self):
        """vertices, triangles, triangle_operand and triangle_source, valid until the Boolean changes or is evaluated again"""
        r = native.gxb_boolean_result()
        _call(native.gxb_boolean_evaluate, self._boolean, ctypes.byref(r))
        shapes = {'vertices': (r.vertex_count, 3), 'triangles': (r.triangle_count, 3), 'triangle_operand': r.triangle_count,
                  'triangle_source': r.triangle_count}
        return _Shown(**_numbers(r), **{name: _shown(getattr(r, name), shape, self) for name, shape in shapes.items()})

    def components(self):
        """volume and Euler characteristic of each component, and total_volume; valid as long as the result"""
        c = native.gxb_components()
        _call(native.gxb_boolean_components, self._boolean, ctypes.byref(c))
        return _Shown(count=c.count, total_volume=c.total_volume, volume=_shown(c.volume, c.count, self), euler=_shown(c.euler, c.count, self))


def _set(struct, name, value):
    kind = dict((n, t) for n, t, *_ in struct._fields_)[name]
    if hasattr(kind, '_length_'):
        value = kind(*value)
    setattr(struct, name, value)
