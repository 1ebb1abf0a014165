"""The interface of gxfem for ctypes. Written by `make bindings` from the headers; see gxfem.py."""
from ctypes import CFUNCTYPE, POINTER, Structure
from ctypes import c_char_p, c_double, c_float, c_int, c_int32, c_int8, c_size_t, c_uint, c_uint32, c_uint64, c_uint8, c_void_p

GX_OK = 0
GX_ERROR_ARGUMENT = 1
GX_ERROR_MEMORY = 2
GX_ERROR_NOT_FINITE = 3
GX_ERROR_RANGE = 4
GX_ERROR_INDEX = 5
GX_ERROR_EMPTY = 6
GX_ERROR_INVERTED = 7
GX_ERROR_FLAT = 8
GX_ERROR_OVERLAP = 9
GX_ERROR_NOT_CLOSED = 10
GX_ERROR_LIMIT = 11
GX_ERROR_DIVERGED = 12
GX_ERROR_FREE = 13
GX_ERROR_FORMAT = 14
GX_ERROR_DAMAGED = 15
GX_ERROR_STALE = 16
GX_ERROR_CONFIGURATION = 17
GX_ERROR_SEQUENCE = 18
GX_ERROR_CAPACITY = 19
GXS_STABLE_NEO_HOOKEAN = 0
GXS_ST_VENANT_KIRCHHOFF = 1
GXS_FIXED_COROTATED = 2
GXS_LINEAR = 3
GXS_CUSTOM = 4
GXS_AUTOMATIC = 0
GXS_BLOCK_JACOBI = 1
GXS_MULTIGRID = 2
GXS_VOLUME_RATIO = 3
GXS_MATRIX_FREE = 0
GXS_MATRIX_ASSEMBLED = 1
GXS_BDF1 = 0
GXS_BDF2 = 1
GXS_MIDPOINT = 2
GXS_STATIC = 3
GXS_EXPLICIT = 4
GXS_PAIR_OUTSIDE = 1
GXS_PAIR_WAKES = 2
GXS_STOP_BALANCE = 0
GXS_STOP_ITERATIONS = 1
GXS_STOP_SECONDS = 2
GXS_STOP_ROUNDING = 3
GXS_STOP_ASLEEP = 4
GX_SURFACE_SHEET = 0
GX_SURFACE_SOLID = 1
GX_SURFACE_KEEP = 2
GX_SURFACE_MATERIAL = 3
GX_FRAGMENT_UNCHANGED = 0
GX_FRAGMENT_TOUCHED = 1
GX_FRAGMENT_SPLIT = 2
GX_FRAGMENT_CREATED = 3
GX_REGION_HALF_SPACE = 0
GX_REGION_BOX = 1
GX_REGION_SPHERE = 2
GX_REGION_SURFACE = 3
GX_REGION_NODES = 4
GX_REGION_ANCHORS = 5
GX_COLLIDER_PLANE = 0
GX_COLLIDER_SPHERE = 1
GX_COLLIDER_CAPSULE = 2
GX_COLLIDER_BOX = 3
GX_COLLIDER_DISTANCE = 4
GX_CONTACT_BEGAN = 0
GX_CONTACT_PERSISTS = 1
GX_CONTACT_ENDED = 2
GX_SKIN_OUTER = 0
GXB_EXPLICIT = 0
GXB_LINE_PLANE = 1
GXB_THREE_PLANES = 2
GXB_UNION = 0
GXB_INTERSECTION = 1
GXB_DIFFERENCE = 2
GXB_SYMMETRIC_DIFFERENCE = 3
GXB_SPLIT = 4
GXB_NONZERO = 0
GXB_POSITIVE = 1
GXB_NEGATIVE = 2
GXB_ODD = 3
GXB_DIVIDED = 0
GXB_COARSE = 1
GXB_MERGED = 2
GXB_FROM_VERTEX = 0
GXB_FROM_EDGE_TRIANGLE = 1
GXB_FROM_EDGE_EDGE = 2
GXB_FROM_THREE_TRIANGLES = 3


class gx_failure(Structure):
    pass


class gx_allocator(Structure):
    pass


class gx_jobs(Structure):
    pass


class gxs_material(Structure):
    pass


class gxs_element(Structure):
    pass


class gxs_constraint(Structure):
    pass


class gxs_model(Structure):
    pass


class gxs_change(Structure):
    pass


class gxs_solver_desc(Structure):
    pass


class gxs_point(Structure):
    pass


class gxs_spring(Structure):
    pass


class gxs_plane(Structure):
    pass


class gxs_pair(Structure):
    pass


class gxs_step_desc(Structure):
    pass


class gxs_step_report(Structure):
    pass


class gxs_scene(Structure):
    pass


class gxs_solver(Structure):
    pass


class gx_body(Structure):
    pass


class gx_material(Structure):
    pass


class gx_surface(Structure):
    pass


class gx_shape(Structure):
    pass


class gx_body_desc(Structure):
    pass


class gx_cut_desc(Structure):
    pass


class gx_cut_report(Structure):
    pass


class gx_view(Structure):
    pass


class gx_motion(Structure):
    pass


class gx_anchor(Structure):
    pass


class gx_region(Structure):
    pass


class gx_collider(Structure):
    pass


class gx_collider_load(Structure):
    pass


class gx_step_desc(Structure):
    pass


class gx_contact_desc(Structure):
    pass


class gx_contact(Structure):
    pass


class gx_contact_event(Structure):
    pass


class gx_group(Structure):
    pass


class gx_group_contact(Structure):
    pass


class gx_group_contact_event(Structure):
    pass


class gx_skin_desc(Structure):
    pass


class gx_range(Structure):
    pass


class gx_skin(Structure):
    pass


class gx_hit(Structure):
    pass


class gx_blade(Structure):
    pass


class gx_blade_desc(Structure):
    pass


class gx_blade_report(Structure):
    pass


class gx_blade_contact(Structure):
    pass


class gxb_num(Structure):
    pass


class gxb_fixed(Structure):
    pass


class gxb_plane_filter(Structure):
    pass


class gxb_ball(Structure):
    pass


class gxb_plane(Structure):
    pass


class gxb_point(Structure):
    pass


class gxb_cpoint(Structure):
    pass


class gxb_cplane(Structure):
    pass


class gxb_edge(Structure):
    pass


class gxb_facet(Structure):
    pass


class gxb_label(Structure):
    pass


class gxb_leaf(Structure):
    pass


class gxb_node(Structure):
    pass


class gxb_block(Structure):
    pass


class gxb_triangle(Structure):
    pass


class gxb_mesh(Structure):
    pass


class gxb_undo(Structure):
    pass


class gxb_store(Structure):
    pass


class gxb_complex(Structure):
    pass


class gxb_renumbering(Structure):
    pass


class gxb_pullback(Structure):
    pass


class gxb_stream(Structure):
    pass


class gxb_boolean(Structure):
    pass


class gxb_operand(Structure):
    pass


class gxb_boolean_desc(Structure):
    pass


class gxb_origin(Structure):
    pass


class gxb_boolean_result(Structure):
    pass


class gxb_range(Structure):
    pass


class gxb_changes(Structure):
    pass


class gxb_components(Structure):
    pass


class gxb_defects(Structure):
    pass


class gxb_statistics(Structure):
    pass


class gxi_surface(Structure):
    pass


class gxi_moments2(Structure):
    pass


gx_failure._fields_ = [
    ('result', c_int),
    ('field', c_char_p),
    ('index', c_size_t),
    ('surface', c_size_t),
]

gx_allocator._fields_ = [
    ('allocate', CFUNCTYPE(c_void_p, c_void_p, c_size_t)),
    ('release', CFUNCTYPE(None, c_void_p, c_void_p, c_size_t)),
    ('user', c_void_p),
    ('reallocate', CFUNCTYPE(c_void_p, c_void_p, c_void_p, c_size_t, c_size_t)),
]

gx_jobs._fields_ = [
    ('parallel_for', CFUNCTYPE(None, c_void_p, c_size_t, CFUNCTYPE(None, c_void_p, c_size_t), c_void_p)),
    ('user', c_void_p),
]

gxs_energy_fn = CFUNCTYPE(c_double, c_void_p, POINTER(c_double), POINTER(c_double), POINTER(c_double))

gxs_material._fields_ = [
    ('kind', c_int),
    ('young', c_double),
    ('poisson', c_double),
    ('damping', c_double),
    ('energy', CFUNCTYPE(c_double, c_void_p, POINTER(c_double), POINTER(c_double), POINTER(c_double))),
    ('user', c_void_p),
]

gxs_element._fields_ = [
    ('copy', c_uint32 * 4),
    ('gradient', (c_double * 3) * 4),
    ('weight', c_double),
    ('mass', c_double * 10),
    ('material', c_uint32),
    ('group', c_uint32),
]

gxs_constraint._fields_ = [
    ('copy', c_uint32),
    ('master', c_uint32 * 4),
    ('weight', c_double * 4),
]

gxs_model._fields_ = [
    ('copy_count', c_size_t),
    ('positions', POINTER(c_double)),
    ('elements', POINTER(gxs_element)),
    ('element_count', c_size_t),
    ('materials', POINTER(gxs_material)),
    ('material_count', c_size_t),
    ('held', POINTER(c_uint8)),
    ('lumped_mass', c_uint32),
    ('constraints', POINTER(gxs_constraint)),
    ('constraint_count', c_size_t),
    ('epoch', c_uint64),
    ('affine', POINTER(c_uint32)),
    ('affine_length', c_double),
]

gxs_change._fields_ = [
    ('copy_count', c_size_t),
    ('origins', POINTER(c_uint32)),
    ('held', POINTER(c_uint8)),
    ('groups', POINTER(c_uint32)),
    ('group_count', c_size_t),
    ('elements', POINTER(gxs_element)),
    ('element_count', c_size_t),
    ('constraints', POINTER(gxs_constraint)),
    ('constraint_count', c_size_t),
    ('affine', POINTER(c_uint32)),
    ('epoch', c_uint64),
]

gxs_solver_desc._fields_ = [
    ('allocator', gx_allocator),
    ('jobs', gx_jobs),
    ('preconditioner', c_int),
    ('matrix', c_int),
]

gxs_point._fields_ = [
    ('count', c_uint32),
    ('copy', c_uint32 * 4),
    ('weight', c_double * 4),
    ('copies', POINTER(c_uint32)),
    ('weights', POINTER(c_double)),
    ('position', c_double * 3),
    ('epoch', c_uint64),
]

gxs_spring._fields_ = [
    ('point', gxs_point),
    ('target', c_double * 3),
    ('stiffness', c_double),
]

gxs_plane._fields_ = [
    ('normal', c_double * 3),
    ('offset', c_double),
    ('stiffness', c_double),
    ('friction', c_double),
    ('sticking_speed', c_double),
]

gxs_contact_fn = CFUNCTYPE(c_double, c_void_p, c_size_t, POINTER(c_double), POINTER(c_double), POINTER(c_double))

gxs_pair._fields_ = [
    ('point', gxs_point),
    ('flags', c_uint32),
    ('way', c_double * 3),
    ('normal', c_double * 3),
    ('offset', c_double),
    ('stiffness', c_double),
    ('friction', c_double),
    ('sticking_speed', c_double),
]

gxs_step_desc._fields_ = [
    ('dt', c_double),
    ('gravity', c_double * 3),
    ('forces', POINTER(c_double)),
    ('integrator', c_int),
    ('previous_displacement', POINTER(c_double)),
    ('previous_velocity', POINTER(c_double)),
    ('previous_dt', c_double),
    ('targets', POINTER(c_double)),
    ('epoch', c_uint64),
    ('mass_damping', c_double),
    ('substeps', c_uint32),
    ('newton_iterations', c_uint32),
    ('quick', c_uint32),
    ('newton_tolerance', c_double),
    ('cg_iterations', c_uint32),
    ('cg_tolerance', c_double),
    ('springs', POINTER(gxs_spring)),
    ('spring_count', c_size_t),
    ('spring_forces', POINTER(c_double)),
    ('points', POINTER(gxs_point)),
    ('point_count', c_size_t),
    ('planes', POINTER(gxs_plane)),
    ('plane_count', c_size_t),
    ('contact', CFUNCTYPE(c_double, c_void_p, c_size_t, POINTER(c_double), POINTER(c_double), POINTER(c_double))),
    ('contact_user', c_void_p),
    ('pairs', POINTER(gxs_pair)),
    ('pair_count', c_size_t),
    ('pair_slips', POINTER(c_double)),
    ('pair_forces', POINTER(c_double)),
    ('sleep_speed', c_double),
    ('sleep_time', c_double),
    ('rest_times', POINTER(c_double)),
    ('clock', CFUNCTYPE(c_double, c_void_p)),
    ('clock_user', c_void_p),
    ('budget_seconds', c_double),
    ('quality', c_double),
]

gxs_step_report._fields_ = [
    ('stop', c_int),
    ('active_unknowns', c_size_t),
    ('substeps', c_uint32),
    ('quick', c_uint32),
    ('parts', c_uint32),
    ('integrator', c_int),
    ('error', c_double),
    ('newton_iterations', c_uint32),
    ('cg_iterations', c_uint32),
    ('line_search_steps', c_uint32),
    ('residual', c_double),
    ('energy', c_double),
    ('preconditioner', c_int),
    ('seconds', c_double),
    ('seconds_linearise', c_double),
    ('seconds_prepare', c_double),
    ('seconds_solve', c_double),
]

gxs_scene._fields_ = [
    ('gravity', c_double * 3),
    ('planes', c_uint64),
    ('forces', c_uint64),
    ('springs', c_uint64),
]

gx_material._fields_ = [
    ('elastic', gxs_material),
    ('density', c_double),
]

gx_surface._fields_ = [
    ('vertices', POINTER(c_double)),
    ('vertex_count', c_size_t),
    ('triangles', POINTER(c_uint32)),
    ('triangle_count', c_size_t),
    ('kind', c_uint32),
    ('texture', POINTER(c_float)),
    ('scope_slots', POINTER(c_uint32)),
    ('scope_slot_count', c_size_t),
    ('material', c_uint32),
]

gx_shape._fields_ = [
    ('surfaces', POINTER(gx_surface)),
    ('surface_count', c_size_t),
    ('cells', c_uint32),
    ('edge', c_double),
    ('unknowns', c_size_t),
]

gx_body_desc._fields_ = [
    ('positions', POINTER(c_double)),
    ('node_count', c_size_t),
    ('elements', POINTER(c_uint32)),
    ('element_count', c_size_t),
    ('young', c_double),
    ('poisson', c_double),
    ('density', c_double),
    ('materials', POINTER(gx_material)),
    ('material_count', c_size_t),
    ('element_materials', POINTER(c_uint32)),
    ('texture', POINTER(c_float)),
    ('support_below', c_double),
    ('affine_below', c_double),
    ('allocator', gx_allocator),
    ('clock', CFUNCTYPE(c_double, c_void_p)),
    ('clock_user', c_void_p),
    ('jobs', gx_jobs),
    ('shape', POINTER(gx_shape)),
]

gx_cut_desc._fields_ = [
    ('surfaces', POINTER(gx_surface)),
    ('surface_count', c_size_t),
    ('scope_fragments', POINTER(c_uint32)),
    ('scope_fragment_count', c_size_t),
    ('scope_cells', POINTER(c_uint32)),
    ('scope_cell_count', c_size_t),
    ('sever_below', c_double),
    ('release', POINTER(c_uint32)),
    ('release_count', c_size_t),
]

gx_cut_report._fields_ = [
    ('touched_elements', c_size_t),
    ('created_cells', c_size_t),
    ('removed_cells', c_size_t),
    ('created_copies', c_size_t),
    ('removed_copies', c_size_t),
    ('ignored_triangles', c_size_t),
    ('severed_links', c_size_t),
    ('min_link_ratio', c_double),
    ('removed_volume', c_double),
    ('seconds_arrangement', c_double),
    ('seconds_enrichment', c_double),
    ('seconds_integrals', c_double),
]

gx_view._fields_ = [
    ('node_count', c_size_t),
    ('element_count', c_size_t),
    ('cell_count', c_size_t),
    ('cell_element', POINTER(c_uint32)),
    ('cell_copies', POINTER(c_uint32)),
    ('cell_volume', POINTER(c_double)),
    ('cell_fragment', POINTER(c_uint32)),
    ('cell_slot', POINTER(c_uint32)),
    ('slot_count', c_size_t),
    ('slot_parent', POINTER(c_uint32)),
    ('copy_count', c_size_t),
    ('copy_node', POINTER(c_uint32)),
    ('copy_held', POINTER(c_uint8)),
    ('copy_region', POINTER(c_uint32)),
    ('epoch', c_uint64),
    ('displacement', POINTER(c_double)),
    ('velocity', POINTER(c_double)),
    ('rest_time', POINTER(c_double)),
    ('fragment_count', c_size_t),
    ('fragment_volume', POINTER(c_double)),
    ('fragment_mass', POINTER(c_double)),
    ('fragment_center', POINTER(c_double)),
    ('fragment_inertia', POINTER(c_double)),
    ('fragment_id', POINTER(c_uint32)),
    ('fragment_origin', POINTER(c_uint32)),
    ('fragment_change', POINTER(c_uint32)),
    ('removed_count', c_size_t),
    ('removed_ids', POINTER(c_uint32)),
    ('volume', c_double),
    ('mass', c_double),
    ('copy_affine', POINTER(c_uint8)),
    ('affine', POINTER(c_double)),
    ('affine_rate', POINTER(c_double)),
    ('positions', POINTER(c_double)),
    ('elements', POINTER(c_uint32)),
    ('cell_material', POINTER(c_uint32)),
]

gx_motion._fields_ = [
    ('mass', c_double),
    ('center', c_double * 3),
    ('inertia', c_double * 6),
    ('velocity', c_double * 3),
    ('angular_velocity', c_double * 3),
    ('energy', c_double),
]

gx_anchor._fields_ = [
    ('element', c_uint32),
    ('position', c_double * 3),
    ('toward', c_double * 3),
]

gx_region._fields_ = [
    ('axis', c_uint32),
    ('side', c_int32),
    ('value', c_double),
    ('kind', c_uint32),
    ('low', c_double * 3),
    ('high', c_double * 3),
    ('center', c_double * 3),
    ('radius', c_double),
    ('surface', POINTER(gx_surface)),
    ('nodes', POINTER(c_uint32)),
    ('node_count', c_size_t),
    ('anchors', POINTER(gx_anchor)),
    ('anchor_count', c_size_t),
]

gx_distance_fn = CFUNCTYPE(c_double, c_void_p, POINTER(c_double), POINTER(c_double))

gx_collider._fields_ = [
    ('id', c_uint32),
    ('kind', c_uint32),
    ('size', c_double * 3),
    ('pose', c_double * 12),
    ('velocity', c_double * 3),
    ('spin', c_double * 3),
    ('friction', c_double),
    ('distance', CFUNCTYPE(c_double, c_void_p, POINTER(c_double), POINTER(c_double))),
    ('user', c_void_p),
]

gx_collider_load._fields_ = [
    ('force', c_double * 3),
    ('torque', c_double * 3),
    ('stiffness', c_double * 36),
    ('contacts', c_uint32),
]

gx_step_desc._fields_ = [
    ('dt', c_double),
    ('gravity', c_double * 3),
    ('integrator', c_int),
    ('substeps', c_uint32),
    ('quick', c_uint32),
    ('newton_iterations', c_uint32),
    ('newton_tolerance', c_double),
    ('cg_iterations', c_uint32),
    ('cg_tolerance', c_double),
    ('mass_damping', c_double),
    ('forces', POINTER(c_double)),
    ('targets', POINTER(c_double)),
    ('region_poses', POINTER(c_double)),
    ('epoch', c_uint64),
    ('springs', POINTER(gxs_spring)),
    ('spring_count', c_size_t),
    ('spring_anchors', POINTER(gx_anchor)),
    ('spring_forces', POINTER(c_double)),
    ('points', POINTER(gxs_point)),
    ('point_count', c_size_t),
    ('point_anchors', POINTER(gx_anchor)),
    ('force_anchors', POINTER(gx_anchor)),
    ('anchor_forces', POINTER(c_double)),
    ('force_count', c_size_t),
    ('planes', POINTER(gxs_plane)),
    ('plane_count', c_size_t),
    ('contact', CFUNCTYPE(c_double, c_void_p, c_size_t, POINTER(c_double), POINTER(c_double), POINTER(c_double))),
    ('contact_user', c_void_p),
    ('pairs', POINTER(gxs_pair)),
    ('pair_count', c_size_t),
    ('pair_anchors', POINTER(gx_anchor)),
    ('pair_slips', POINTER(c_double)),
    ('pair_forces', POINTER(c_double)),
    ('colliders', POINTER(gx_collider)),
    ('collider_count', c_size_t),
    ('collider_loads', POINTER(gx_collider_load)),
    ('contact_filter', CFUNCTYPE(c_int, c_void_p, c_uint32, c_uint32, c_uint32)),
    ('contact_filter_user', c_void_p),
    ('sleep_speed', c_double),
    ('sleep_time', c_double),
    ('clock', CFUNCTYPE(c_double, c_void_p)),
    ('clock_user', c_void_p),
    ('budget_seconds', c_double),
    ('quality', c_double),
]

gx_step_report = gxs_step_report

gx_contact_desc._fields_ = [
    ('stiffness', c_double),
    ('friction', c_double),
    ('sticking_speed', c_double),
    ('recovery', c_double),
    ('depth', c_double),
    ('max_pairs', c_uint32),
]

gx_contact._fields_ = [
    ('fragment', c_uint32),
    ('other', c_uint32),
    ('collider', c_uint32),
    ('position', c_double * 3),
    ('normal', c_double * 3),
    ('force', c_double * 3),
    ('depth', c_double),
]

gx_contact_event._fields_ = [
    ('change', c_uint32),
    ('fragment', c_uint32),
    ('other', c_uint32),
    ('collider', c_uint32),
    ('contacts', c_uint32),
    ('force', c_double * 3),
    ('load', c_double),
    ('position', c_double * 3),
    ('normal', c_double * 3),
]

gx_group_contact._fields_ = [
    ('body', c_uint32),
    ('other_body', c_uint32),
    ('contact', gx_contact),
]

gx_group_contact_event._fields_ = [
    ('body', c_uint32),
    ('other_body', c_uint32),
    ('event', gx_contact_event),
]

gx_skin_desc._fields_ = [
    ('crease_angle', c_double),
    ('smooth_cuts', c_int),
]

gx_range._fields_ = [
    ('first', c_uint32),
    ('count', c_uint32),
]

gx_skin._fields_ = [
    ('vertex_count', c_size_t),
    ('vertex_width', c_uint32),
    ('vertex_copies', POINTER(c_uint32)),
    ('vertex_weights', POINTER(c_double)),
    ('vertex_point', POINTER(c_uint32)),
    ('vertex_rest', POINTER(c_double)),
    ('vertex_normal', POINTER(c_float)),
    ('vertex_texture', POINTER(c_float)),
    ('triangle_count', c_size_t),
    ('triangles', POINTER(c_uint32)),
    ('triangle_fragment', POINTER(c_uint32)),
    ('triangle_element', POINTER(c_uint32)),
    ('triangle_material', POINTER(c_uint32)),
    ('triangle_surface', POINTER(c_uint32)),
    ('vertex_ranges', POINTER(gx_range)),
    ('vertex_range_count', c_size_t),
    ('triangle_ranges', POINTER(gx_range)),
    ('triangle_range_count', c_size_t),
    ('epoch', c_uint64),
]

gx_hit._fields_ = [
    ('triangle', c_uint32),
    ('fragment', c_uint32),
    ('element', c_uint32),
    ('surface', c_uint32),
    ('cell', c_uint32),
    ('slot', c_uint32),
    ('slot_count', c_uint32),
    ('distance', c_double),
    ('position', c_double * 3),
    ('material', c_double * 3),
    ('copy_count', c_uint32),
    ('copies', c_uint32 * 16),
    ('weights', c_double * 16),
    ('epoch', c_uint64),
]

gx_blade_desc._fields_ = [
    ('tolerance', c_double),
    ('min_advance', c_double),
    ('max_samples', c_uint32),
    ('starts_inside', c_int),
]

gx_blade_report._fields_ = [
    ('layer_count', c_size_t),
    ('triangle_count', c_size_t),
    ('deviation', c_double),
    ('cut', gx_cut_report),
]

gx_blade_contact._fields_ = [
    ('hit', gx_hit),
    ('along', c_double),
    ('length', c_double),
]

gxb_limb = c_uint64

gxb_num._fields_ = [
    ('sign', c_int32),
    ('exp', c_int32),
    ('n', c_uint32),
    ('d', POINTER(c_uint64)),
]

gxb_fixed._fields_ = [
    ('d', c_uint64 * 3),
]

gxb_plane_filter._fields_ = [
    ('n', c_double * 3),
    ('base', c_double * 3),
    ('base_error', c_double),
    ('error', c_double),
    ('norm', c_double),
]

gxb_ball._fields_ = [
    ('x', c_double * 3),
    ('error', c_double),
]

gxb_plane._fields_ = [
    ('filter', gxb_plane_filter),
    ('p', POINTER(c_double)),
    ('q', POINTER(c_double)),
    ('r', POINTER(c_double)),
]

gxb_point._fields_ = [
    ('ball', gxb_ball),
    ('p', POINTER(c_double)),
    ('q', POINTER(c_double)),
    ('plane', POINTER(gxb_plane) * 3),
]

gxb_cpoint._fields_ = [
    ('ball', gxb_ball),
    ('def', c_uint32 * 3),
    ('kind', c_uint8),
    ('wall', c_uint8),
    ('sign', c_int8 * 2),
    ('stamp', c_uint32 * 2),
    ('exact', POINTER(gxb_num)),
    ('parameter', c_double * 3),
    ('rim_edge', c_uint32),
    ('name', c_uint32),
]

gxb_cplane._fields_ = [
    ('filter', gxb_plane_filter),
    ('exact', POINTER(gxb_num)),
    ('def', c_uint32 * 3),
    ('along_axis', c_uint8),
    ('axis', c_uint8),
    ('axis_sign', c_int8),
]

gxb_edge._fields_ = [
    ('v', c_uint32 * 2),
    ('line', c_uint32 * 2),
    ('child', c_uint32),
    ('explicit_line', c_uint32, 1),
    ('wall', c_uint32, 1),
    ('stamp', c_uint32, 30),
]

gxb_facet._fields_ = [
    ('plane', c_uint32),
    ('loop', c_uint32),
    ('loop_count', c_uint32, 31),
    ('wall', c_uint32, 1),
    ('leaf', c_uint32 * 2),
    ('child', c_uint32),
    ('labels', c_uint32),
    ('face', c_uint32),
]

gxb_label._fields_ = [
    ('triangle', c_uint32),
    ('orientation', c_int32),
    ('next', c_uint32),
]

gxb_leaf._fields_ = [
    ('element', c_uint32),
    ('facets', c_uint32),
    ('facet_count', c_uint32),
    ('parent', c_uint32),
    ('removed', c_uint32),
]

gxb_node._fields_ = [
    ('plane', c_uint32),
    ('child', c_uint32 * 2),
    ('parent', c_uint32),
    ('leaves', c_uint32),
    ('facet', c_uint32),
]

gxb_block._fields_ = [
    ('next', POINTER(gxb_block)),
    ('size', c_size_t),
    ('used', c_size_t),
]

gxb_triangle._fields_ = [
    ('point', c_uint32 * 3),
    ('plane', c_uint32),
    ('orientation', c_int32),
    ('edge_plane', c_uint32 * 3),
    ('label', c_uint32),
    ('wall', c_uint32),
]

gxb_mesh._fields_ = [
    ('positions', POINTER(c_double)),
    ('node_count', c_size_t),
    ('elements', POINTER(c_uint32)),
    ('element_count', c_size_t),
]

gxb_undo._fields_ = [
    ('array', c_uint32),
    ('index', c_uint32),
]

gxb_store._fields_ = [
    ('points', POINTER(gxb_cpoint)),
    ('point_count', c_uint32),
    ('point_capacity', c_uint32),
    ('planes', POINTER(gxb_cplane)),
    ('plane_count', c_uint32),
    ('plane_capacity', c_uint32),
    ('stamp', c_uint32 * 2),
    ('shift', c_int),
    ('origin', c_double * 3),
    ('blocks', POINTER(gxb_block)),
    ('mark', c_uint32 * 2),
    ('next_name', c_uint32),
    ('mark_name', c_uint32),
    ('mark_block', POINTER(gxb_block)),
    ('mark_used', c_size_t),
    ('undo', POINTER(gxb_undo)),
    ('undo_count', c_uint32),
    ('undo_capacity', c_uint32),
    ('undo_bytes', POINTER(c_uint8)),
    ('undo_byte_count', c_uint32),
    ('undo_byte_capacity', c_uint32),
    ('filter_calls', c_uint64),
    ('exact_calls', c_uint64),
    ('allocator', gx_allocator),
]

gxb_complex._fields_ = [
    ('store', gxb_store),
    ('edges', POINTER(gxb_edge)),
    ('edge_count', c_uint32),
    ('edge_capacity', c_uint32),
    ('facets', POINTER(gxb_facet)),
    ('facet_count', c_uint32),
    ('facet_capacity', c_uint32),
    ('leaves', POINTER(gxb_leaf)),
    ('leaf_count', c_uint32),
    ('leaf_capacity', c_uint32),
    ('nodes', POINTER(gxb_node)),
    ('tree_count', c_uint32),
    ('tree_capacity', c_uint32),
    ('pool', POINTER(c_uint32)),
    ('pool_count', c_uint32),
    ('pool_capacity', c_uint32),
    ('elements', POINTER(c_uint32)),
    ('element_faces', POINTER(c_uint32)),
    ('element_edges', POINTER(c_uint32)),
    ('face_elements', POINTER(c_uint32)),
    ('face_facet', POINTER(c_uint32)),
    ('mesh_edge', POINTER(c_uint32)),
    ('root', POINTER(c_uint32)),
    ('node_count', c_uint32),
    ('element_count', c_uint32),
    ('face_count', c_uint32),
    ('mesh_edge_count', c_uint32),
    ('pool_live', c_uint32),
    ('mark_live', c_uint32),
    ('removed_count', c_uint32),
    ('mark_removed', c_uint32),
    ('settled', c_uint64),
    ('labels', POINTER(gxb_label)),
    ('label_count', c_uint32),
    ('label_capacity', c_uint32),
    ('marked', POINTER(c_uint32)),
    ('marked_count', c_uint32),
    ('marked_capacity', c_uint32),
    ('corners', c_void_p),
    ('corner_count', c_uint32),
    ('corner_capacity', c_uint32),
    ('tasks', c_void_p),
    ('task_count', c_uint32),
    ('task_capacity', c_uint32),
    ('leaf_facets', POINTER(c_uint32)),
    ('leaf_facet_count', c_uint32),
    ('leaf_facet_capacity', c_uint32),
    ('leaf_signs', POINTER(c_uint32)),
    ('leaf_sign_count', c_uint32),
    ('leaf_sign_capacity', c_uint32),
    ('rim', POINTER(c_uint32)),
    ('rim_count', c_uint32),
    ('rim_capacity', c_uint32),
    ('front_facets', POINTER(c_uint32)),
    ('front_facet_count', c_uint32),
    ('front_facet_capacity', c_uint32),
    ('behind_facets', POINTER(c_uint32)),
    ('behind_facet_count', c_uint32),
    ('behind_facet_capacity', c_uint32),
    ('loop', POINTER(c_uint32)),
    ('loop_count', c_uint32),
    ('loop_capacity', c_uint32),
    ('inner_facets', POINTER(c_uint32)),
    ('inner_facet_count', c_uint32),
    ('inner_facet_capacity', c_uint32),
    ('mark', c_uint32 * 6),
    ('edge_stamp', c_uint32),
    ('sign_plane', c_uint32),
    ('pairs', c_void_p),
]

gxb_renumbering._fields_ = [
    ('leaves', POINTER(c_uint32)),
    ('planes', POINTER(c_uint32)),
    ('leaf_count', c_uint32),
    ('plane_count', c_uint32),
    ('leaf_of', POINTER(c_uint32)),
    ('changed', POINTER(c_uint32)),
    ('renamed', c_int),
    ('memory', c_void_p),
    ('size', c_size_t),
]

gxb_pullback._fields_ = [
    ('corners', POINTER(c_double)),
    ('point', POINTER(c_double)),
    ('d', c_double * 4),
    ('error', c_double),
    ('sign', c_int8 * 4),
    ('orientation', c_int8),
]

gxb_stream._fields_ = [
    ('out', POINTER(c_uint8)),
    ('in', POINTER(c_uint8)),
    ('size', c_size_t),
    ('at', c_size_t),
    ('result', c_int),
]

gxb_operand._fields_ = [
    ('vertices', POINTER(c_double)),
    ('vertex_count', c_size_t),
    ('triangles', POINTER(c_uint32)),
    ('triangle_count', c_size_t),
    ('operation', c_uint32),
    ('rule', c_uint32),
    ('simple', c_uint32),
]

gxb_boolean_desc._fields_ = [
    ('allocator', gx_allocator),
    ('memory_limit', c_size_t),
    ('inside', CFUNCTYPE(c_int, c_void_p, POINTER(c_int32), c_size_t)),
    ('user', c_void_p),
    ('jobs', gx_jobs),
]

gxb_origin._fields_ = [
    ('kind', c_uint32),
    ('operand', c_uint32 * 3),
    ('index', c_uint32 * 3),
]

gxb_boolean_result._fields_ = [
    ('vertices', POINTER(c_double)),
    ('vertex_count', c_size_t),
    ('triangles', POINTER(c_uint32)),
    ('triangle_count', c_size_t),
    ('vertex_origin', POINTER(gxb_origin)),
    ('triangle_operand', POINTER(c_uint32)),
    ('triangle_source', POINTER(c_uint32)),
    ('triangle_reversed', POINTER(c_uint8)),
]

gxb_range._fields_ = [
    ('first', c_size_t),
    ('count', c_size_t),
]

gxb_changes._fields_ = [
    ('vertices', POINTER(gxb_range)),
    ('vertex_range_count', c_size_t),
    ('triangles', POINTER(gxb_range)),
    ('triangle_range_count', c_size_t),
]

gxb_components._fields_ = [
    ('count', c_size_t),
    ('volume', POINTER(c_double)),
    ('euler', POINTER(c_int32)),
    ('side', POINTER(c_int8)),
    ('triangle', POINTER(c_uint32)),
    ('total_volume', c_double),
]

gxb_defects._fields_ = [
    ('triangles', POINTER(c_uint32)),
    ('count', c_size_t),
    ('mended_count', c_size_t),
]

gxb_statistics._fields_ = [
    ('filter_calls', c_uint64),
    ('exact_calls', c_uint64),
    ('allocations', c_uint64),
    ('peak_bytes', c_size_t),
]

gxi_surface._fields_ = [
    ('positions', POINTER(c_double)),
    ('position_count', c_size_t),
    ('triangles', POINTER(c_uint32)),
    ('triangle_count', c_size_t),
]

gxi_moments2._fields_ = [
    ('volume', c_double),
    ('first', c_double * 3),
    ('second', c_double * 6),
]

# function: result, parameters
FUNCTIONS = {
    'gx_blade_contacts': (c_int, [POINTER(gx_blade), POINTER(gx_blade_contact), c_size_t, POINTER(c_size_t), POINTER(gx_failure)]),
    'gx_blade_create': (c_int, [POINTER(gx_body), POINTER(gx_blade_desc), POINTER(POINTER(gx_blade)), POINTER(gx_failure)]),
    'gx_blade_destroy': (None, [POINTER(gx_blade)]),
    'gx_blade_lift': (c_int, [POINTER(gx_blade), POINTER(gx_blade_report), POINTER(gx_failure)]),
    'gx_blade_move': (c_int, [POINTER(gx_blade), POINTER(c_double), c_size_t, POINTER(c_uint32), c_size_t, POINTER(gx_blade_report), POINTER(gx_failure)]),
    'gx_body_anchor': (c_int, [POINTER(gx_body), c_uint32, POINTER(c_double), POINTER(gx_anchor), POINTER(gx_failure)]),
    'gx_body_anchor_point': (c_int, [POINTER(gx_body), POINTER(gx_anchor), POINTER(gxs_point), POINTER(c_double), POINTER(gx_failure)]),
    'gx_body_blade': (POINTER(gx_blade), [POINTER(gx_body), c_size_t]),
    'gx_body_carve': (c_int, [POINTER(gx_body), POINTER(gx_surface), POINTER(gx_cut_report), POINTER(gx_failure)]),
    'gx_body_clone': (c_int, [POINTER(gx_body), POINTER(POINTER(gx_body)), POINTER(gx_failure)]),
    'gx_body_contact': (c_int, [POINTER(gx_body), POINTER(gx_contact_desc), POINTER(gx_failure)]),
    'gx_body_contact_events': (c_int, [POINTER(gx_body), POINTER(gx_contact_event), c_size_t, POINTER(c_size_t), POINTER(gx_failure)]),
    'gx_body_contacts': (c_int, [POINTER(gx_body), POINTER(gx_contact), c_size_t, POINTER(c_size_t), POINTER(gx_failure)]),
    'gx_body_create': (c_int, [POINTER(gx_body_desc), POINTER(POINTER(gx_body)), POINTER(gx_failure)]),
    'gx_body_cut': (c_int, [POINTER(gx_body), POINTER(gx_cut_desc), POINTER(gx_cut_report), POINTER(gx_failure)]),
    'gx_body_destroy': (None, [POINTER(gx_body)]),
    'gx_body_hold': (c_int, [POINTER(gx_body), POINTER(gx_region), c_size_t, POINTER(gx_failure)]),
    'gx_body_load': (c_int, [c_void_p, c_size_t, POINTER(gx_body_desc), POINTER(POINTER(gx_body)), POINTER(gx_failure)]),
    'gx_body_locate': (c_int, [POINTER(gx_body), POINTER(c_double), c_size_t, POINTER(gx_hit), POINTER(gx_failure)]),
    'gx_body_locate_all': (c_int, [POINTER(gx_body), POINTER(c_double), POINTER(gx_hit), c_size_t, POINTER(c_size_t), POINTER(gx_failure)]),
    'gx_body_lost_anchors': (c_int, [POINTER(gx_body), POINTER(gx_anchor), c_size_t, POINTER(c_uint8), POINTER(gx_failure)]),
    'gx_body_model': (c_int, [POINTER(gx_body), POINTER(gxs_model), POINTER(gx_failure)]),
    'gx_body_motion': (c_int, [POINTER(gx_body), POINTER(gx_motion), c_size_t, POINTER(gx_failure)]),
    'gx_body_pick': (c_int, [POINTER(gx_body), POINTER(c_double), POINTER(c_double), POINTER(gx_hit), POINTER(gx_failure)]),
    'gx_body_place': (c_int, [POINTER(gx_body), c_uint32, POINTER(c_double), POINTER(c_double), POINTER(gx_failure)]),
    'gx_body_restore': (c_int, [POINTER(gx_body), POINTER(gx_body), POINTER(gx_failure)]),
    'gx_body_save': (c_int, [POINTER(gx_body), c_void_p, c_size_t, POINTER(c_size_t), POINTER(gx_failure)]),
    'gx_body_skin': (c_int, [POINTER(gx_body), POINTER(gx_skin_desc), POINTER(gx_skin), POINTER(gx_failure)]),
    'gx_body_skin_positions': (c_int, [POINTER(gx_body), POINTER(c_double), POINTER(gx_failure)]),
    'gx_body_skin_vertices': (c_int, [POINTER(gx_body), POINTER(c_double), POINTER(c_float), POINTER(c_float), POINTER(gx_failure)]),
    'gx_body_state_hash': (c_uint64, [POINTER(gx_body)]),
    'gx_body_step': (c_int, [POINTER(gx_body), POINTER(gx_step_desc), POINTER(gxs_step_report), POINTER(gx_failure)]),
    'gx_body_topology_hash': (c_uint64, [POINTER(gx_body), POINTER(gx_failure)]),
    'gx_body_view': (c_int, [POINTER(gx_body), POINTER(gx_view), POINTER(gx_failure)]),
    'gx_group_contact_events': (c_int, [POINTER(gx_group), POINTER(gx_group_contact_event), c_size_t, POINTER(c_size_t), POINTER(gx_failure)]),
    'gx_group_contacts': (c_int, [POINTER(gx_group), POINTER(gx_group_contact), c_size_t, POINTER(c_size_t), POINTER(gx_failure)]),
    'gx_group_create': (c_int, [POINTER(POINTER(gx_body)), c_size_t, POINTER(POINTER(gx_group)), POINTER(gx_failure)]),
    'gx_group_destroy': (None, [POINTER(gx_group)]),
    'gx_group_step': (c_int, [POINTER(gx_group), POINTER(gx_step_desc), POINTER(gxs_step_report), POINTER(gx_failure)]),
    'gx_hit_anchor': (c_int, [POINTER(gx_body), POINTER(gx_hit), POINTER(gx_anchor), POINTER(gx_failure)]),
    'gx_hit_point': (gxs_point, [POINTER(gx_hit)]),
    'gx_region_box': (gx_region, [POINTER(c_double), POINTER(c_double)]),
    'gx_region_half_space': (gx_region, [c_uint32, c_int, c_double]),
    'gx_region_sphere': (gx_region, [POINTER(c_double), c_double]),
    'gx_result_text': (c_char_p, [c_int]),
    'gx_skin_point': (gxs_point, [POINTER(gx_skin), c_uint32]),
    'gx_surface_solidify': (c_int, [POINTER(gx_surface), c_double, POINTER(c_double), POINTER(c_size_t), POINTER(c_uint32), POINTER(c_size_t), POINTER(gx_allocator), POINTER(gx_failure)]),
    'gxb_boolean_add': (c_int, [POINTER(gxb_boolean), POINTER(gxb_operand), POINTER(gx_failure)]),
    'gxb_boolean_changes': (c_int, [POINTER(gxb_boolean), POINTER(gxb_changes), POINTER(gx_failure)]),
    'gxb_boolean_components': (c_int, [POINTER(gxb_boolean), POINTER(gxb_components), POINTER(gx_failure)]),
    'gxb_boolean_create': (c_int, [POINTER(gxb_boolean_desc), POINTER(POINTER(gxb_boolean)), POINTER(gx_failure)]),
    'gxb_boolean_defects': (c_int, [POINTER(gxb_boolean), POINTER(gxb_defects), POINTER(gx_failure)]),
    'gxb_boolean_destroy': (None, [POINTER(gxb_boolean)]),
    'gxb_boolean_evaluate': (c_int, [POINTER(gxb_boolean), POINTER(gxb_boolean_result), POINTER(gx_failure)]),
    'gxb_boolean_remove': (c_int, [POINTER(gxb_boolean), c_uint32, POINTER(gx_failure)]),
    'gxb_boolean_set_fine': (c_int, [POINTER(gxb_boolean), c_int, POINTER(gx_failure)]),
    'gxb_boolean_set_mend': (c_int, [POINTER(gxb_boolean), c_int, POINTER(gx_failure)]),
    'gxb_boolean_set_retained': (c_int, [POINTER(gxb_boolean), c_int, POINTER(gx_failure)]),
    'gxb_boolean_set_triangulation': (c_int, [POINTER(gxb_boolean), c_uint32, POINTER(gx_failure)]),
    'gxb_boolean_statistics': (c_int, [POINTER(gxb_boolean), POINTER(gxb_statistics), POINTER(gx_failure)]),
    'gxb_compare': (c_int, [POINTER(gxb_point), POINTER(gxb_point), c_int]),
    'gxb_complex_add_plane': (c_int, [POINTER(gxb_complex), POINTER(gxb_triangle)]),
    'gxb_complex_add_point': (c_int, [POINTER(gxb_complex), POINTER(c_double), POINTER(c_uint32)]),
    'gxb_complex_barycentric': (None, [POINTER(gxb_complex), c_uint32, c_uint32, POINTER(c_double)]),
    'gxb_complex_barycentric_fine': (None, [POINTER(gxb_complex), c_uint32, c_uint32, POINTER(gxb_num)]),
    'gxb_complex_barycentric_fixed': (None, [POINTER(gxb_complex), c_uint32, c_uint32, POINTER(gxb_fixed)]),
    'gxb_complex_begin': (None, [POINTER(gxb_complex)]),
    'gxb_complex_check_point': (c_int, [POINTER(gxb_complex), POINTER(c_double)]),
    'gxb_complex_commit': (None, [POINTER(gxb_complex)]),
    'gxb_complex_compact': (None, [POINTER(gxb_complex), POINTER(gxb_renumbering)]),
    'gxb_complex_compare': (c_int, [POINTER(gxb_complex), c_uint32, c_int, c_double]),
    'gxb_complex_cover_edge': (c_int, [POINTER(gxb_complex), POINTER(gxb_triangle), c_uint32, c_uint32, POINTER(c_int)]),
    'gxb_complex_cover_node': (c_int, [POINTER(gxb_complex), POINTER(gxb_triangle), c_uint32, POINTER(c_int)]),
    'gxb_complex_create': (c_int, [POINTER(gxb_mesh), POINTER(gx_allocator), POINTER(POINTER(gxb_complex)), POINTER(gx_failure)]),
    'gxb_complex_destroy': (None, [POINTER(gxb_complex)]),
    'gxb_complex_edge': (POINTER(gxb_edge), [POINTER(gxb_complex), c_uint32]),
    'gxb_complex_edge_start': (c_uint32, [POINTER(gxb_complex), c_uint32]),
    'gxb_complex_element_count': (c_uint32, [POINTER(gxb_complex)]),
    'gxb_complex_element_edges': (POINTER(c_uint32), [POINTER(gxb_complex), c_uint32]),
    'gxb_complex_element_faces': (POINTER(c_uint32), [POINTER(gxb_complex), c_uint32]),
    'gxb_complex_element_nodes': (POINTER(c_uint32), [POINTER(gxb_complex), c_uint32]),
    'gxb_complex_face_count': (c_uint32, [POINTER(gxb_complex)]),
    'gxb_complex_face_elements': (POINTER(c_uint32), [POINTER(gxb_complex), c_uint32]),
    'gxb_complex_face_facet': (c_uint32, [POINTER(gxb_complex), c_uint32]),
    'gxb_complex_facet': (POINTER(gxb_facet), [POINTER(gxb_complex), c_uint32]),
    'gxb_complex_facet_count': (c_uint32, [POINTER(gxb_complex)]),
    'gxb_complex_forget': (None, [POINTER(gxb_complex), POINTER(gxb_renumbering)]),
    'gxb_complex_insert': (c_int, [POINTER(gxb_complex), POINTER(gxb_triangle), c_uint32, CFUNCTYPE(c_int, c_void_p, c_uint32), c_void_p]),
    'gxb_complex_is_sparse': (c_int, [POINTER(gxb_complex)]),
    'gxb_complex_label': (POINTER(gxb_label), [POINTER(gxb_complex), c_uint32]),
    'gxb_complex_label_count': (c_uint32, [POINTER(gxb_complex)]),
    'gxb_complex_leaf': (POINTER(gxb_leaf), [POINTER(gxb_complex), c_uint32]),
    'gxb_complex_leaf_at': (c_uint32, [POINTER(gxb_complex), c_uint32, POINTER(c_double), POINTER(c_double), POINTER(c_int)]),
    'gxb_complex_leaf_count': (c_uint32, [POINTER(gxb_complex)]),
    'gxb_complex_list': (POINTER(c_uint32), [POINTER(gxb_complex), c_uint32]),
    'gxb_complex_load': (c_int, [POINTER(gxb_complex), POINTER(gxb_stream), c_int]),
    'gxb_complex_marked_count': (c_uint32, [POINTER(gxb_complex)]),
    'gxb_complex_marked_facet': (c_uint32, [POINTER(gxb_complex), c_uint32]),
    'gxb_complex_marked_wall': (c_int, [POINTER(gxb_complex), c_uint32]),
    'gxb_complex_mesh_edge': (c_uint32, [POINTER(gxb_complex), c_uint32]),
    'gxb_complex_mesh_edge_count': (c_uint32, [POINTER(gxb_complex)]),
    'gxb_complex_node_count': (c_uint32, [POINTER(gxb_complex)]),
    'gxb_complex_open_element': (c_int, [POINTER(gxb_complex), c_uint32]),
    'gxb_complex_origin': (POINTER(c_double), [POINTER(gxb_complex)]),
    'gxb_complex_part': (c_int, [POINTER(gxb_complex), c_uint32, POINTER(c_double), POINTER(c_uint32), POINTER(c_uint32), c_uint32, c_uint32, CFUNCTYPE(c_int, c_void_p, c_uint32), c_void_p]),
    'gxb_complex_plane': (POINTER(gxb_cplane), [POINTER(gxb_complex), c_uint32]),
    'gxb_complex_point': (POINTER(gxb_cpoint), [POINTER(gxb_complex), c_uint32]),
    'gxb_complex_point_count': (c_uint32, [POINTER(gxb_complex)]),
    'gxb_complex_prefetch_element': (None, [POINTER(gxb_complex), c_uint32]),
    'gxb_complex_prepare_points': (None, [POINTER(gxb_complex), c_uint32, c_uint32]),
    'gxb_complex_pullback_side': (c_int, [POINTER(gxb_complex), POINTER(gxb_pullback), c_uint32, c_uint32]),
    'gxb_complex_reserve': (None, [POINTER(gxb_complex), c_uint32]),
    'gxb_complex_rollback': (None, [POINTER(gxb_complex)]),
    'gxb_complex_root': (c_uint32, [POINTER(gxb_complex), c_uint32]),
    'gxb_complex_save': (None, [POINTER(gxb_complex), POINTER(gxb_stream)]),
    'gxb_complex_set_removed': (c_int, [POINTER(gxb_complex), c_uint32]),
    'gxb_complex_set_wall': (c_int, [POINTER(gxb_complex), c_uint32]),
    'gxb_complex_shift': (c_int, [POINTER(gxb_complex)]),
    'gxb_complex_side': (c_int, [POINTER(gxb_complex), c_uint32, c_uint32]),
    'gxb_complex_support': (c_uint, [POINTER(gxb_complex), c_uint32, c_uint32]),
    'gxb_complex_survey': (c_int, [POINTER(gxb_complex), POINTER(c_uint8), POINTER(c_uint32), POINTER(gxb_renumbering)]),
    'gxb_complex_tree_node': (POINTER(gxb_node), [POINTER(gxb_complex), c_uint32]),
    'gxb_complex_turn': (c_int, [POINTER(gxb_complex), c_uint32, c_uint32, c_uint32, c_uint32]),
    'gxb_complex_winding': (c_int, [POINTER(gxb_complex), POINTER(c_uint32), c_size_t, POINTER(c_double), POINTER(c_uint32), c_size_t]),
    'gxb_facet_resolve_edges': (c_int, [POINTER(gxb_complex), c_uint32, POINTER(c_uint32), POINTER(c_uint32)]),
    'gxb_fixed_determinant': (c_double, [POINTER(gxb_fixed), POINTER(gxb_fixed), POINTER(gxb_fixed), POINTER(gxb_fixed)]),
    'gxb_incircle': (c_int, [POINTER(c_double), POINTER(c_double), POINTER(c_double), POINTER(c_double)]),
    'gxb_insphere': (c_int, [POINTER(c_double), POINTER(c_double), POINTER(c_double), POINTER(c_double), POINTER(c_double)]),
    'gxb_is_allocator': (c_int, [POINTER(gx_allocator)]),
    'gxb_leaf_resolve_facets': (c_int, [POINTER(gxb_complex), c_uint32, POINTER(c_uint32), POINTER(c_uint32)]),
    'gxb_num_add': (None, [POINTER(gxb_num), POINTER(gxb_num), POINTER(gxb_num)]),
    'gxb_num_mul': (None, [POINTER(gxb_num), POINTER(gxb_num), POINTER(gxb_num)]),
    'gxb_num_ratio': (c_double, [POINTER(gxb_num), POINTER(gxb_num)]),
    'gxb_num_set': (None, [POINTER(gxb_num), c_double, c_int]),
    'gxb_num_sub': (None, [POINTER(gxb_num), POINTER(gxb_num), POINTER(gxb_num)]),
    'gxb_num_to_double': (c_double, [POINTER(gxb_num)]),
    'gxb_orient2d': (c_int, [POINTER(c_double), POINTER(c_double), POINTER(c_double)]),
    'gxb_orient3d': (c_int, [POINTER(c_double), POINTER(c_double), POINTER(c_double), POINTER(c_double)]),
    'gxb_orient_in_plane': (c_int, [POINTER(gxb_point), POINTER(gxb_point), POINTER(gxb_point), POINTER(gxb_plane)]),
    'gxb_plane_init': (None, [POINTER(gxb_plane), POINTER(c_double), POINTER(c_double), POINTER(c_double)]),
    'gxb_point_explicit': (None, [POINTER(gxb_point), POINTER(c_double)]),
    'gxb_point_line_plane': (None, [POINTER(gxb_point), POINTER(c_double), POINTER(c_double), POINTER(gxb_plane)]),
    'gxb_point_three_planes': (None, [POINTER(gxb_point), POINTER(gxb_plane), POINTER(gxb_plane), POINTER(gxb_plane)]),
    'gxb_pullback_contains': (c_int, [POINTER(gxb_pullback)]),
    'gxb_pullback_misses': (c_int, [POINTER(c_double), POINTER(c_double)]),
    'gxb_pullback_orient': (c_int, [POINTER(gxb_pullback)]),
    'gxb_pullback_set': (None, [POINTER(gxb_pullback), POINTER(c_double), POINTER(c_double)]),
    'gxb_pullback_weights': (None, [POINTER(gxb_pullback), POINTER(c_double)]),
    'gxb_side': (c_int, [POINTER(gxb_point), POINTER(gxb_plane)]),
    'gxb_stream_has': (c_int, [POINTER(gxb_stream), c_size_t, c_size_t]),
    'gxb_stream_pass': (None, [POINTER(gxb_stream), c_void_p, c_size_t, c_size_t]),
    'gxb_winding_number': (c_int, [POINTER(c_double), POINTER(c_uint32), c_size_t, POINTER(c_double), POINTER(c_int)]),
    'gxi_face_load_add': (None, [POINTER(c_double), POINTER(c_double), POINTER(c_double), c_double, POINTER(c_double)]),
    'gxi_face_mass_add': (None, [POINTER(c_double), POINTER(c_double), POINTER(c_double), c_double, POINTER(c_double)]),
    'gxi_moments2_add': (None, [POINTER(gxi_moments2), POINTER(gxi_moments2)]),
    'gxi_moments2_add_triangle': (None, [POINTER(gxi_moments2), POINTER(c_double), POINTER(c_double), POINTER(c_double)]),
    'gxi_moments2_inertia': (None, [POINTER(gxi_moments2), c_double, POINTER(c_double), POINTER(c_double)]),
    'gxi_moments2_map': (None, [POINTER(gxi_moments2), POINTER(c_double), POINTER(c_double)]),
    'gxi_moments2_repair': (c_int, [POINTER(gxi_moments2), POINTER(c_double), POINTER(c_double)]),
    'gxi_moments2_translate': (None, [POINTER(gxi_moments2), POINTER(c_double)]),
    'gxi_monomial_count': (c_size_t, [c_uint]),
    'gxi_monomial_index': (c_size_t, [c_uint, c_uint, c_uint]),
    'gxi_monomials_translate': (c_int, [c_uint, POINTER(c_double), POINTER(c_double), POINTER(gx_failure)]),
    'gxi_part_axes': (None, [c_uint, POINTER(c_uint)]),
    'gxi_part_load': (None, [POINTER(gxi_moments2), c_uint, c_double, c_double, POINTER(c_double)]),
    'gxi_part_mass': (None, [POINTER(gxi_moments2), c_uint, c_double, c_double, POINTER(c_double)]),
    'gxi_part_moments': (c_int, [POINTER(c_double), c_size_t, POINTER(c_uint32), c_size_t, POINTER(c_uint), POINTER(gxi_moments2)]),
    'gxi_part_moments_at': (c_int, [POINTER(c_double), c_size_t, POINTER(c_uint32), c_size_t, c_uint, POINTER(gxi_moments2)]),
    'gxi_polyhedron_moments2': (c_int, [POINTER(gxi_surface), POINTER(c_double), POINTER(gxi_moments2), POINTER(gx_failure)]),
    'gxi_polyhedron_monomial': (c_int, [POINTER(gxi_surface), POINTER(c_double), c_uint, c_uint, c_uint, POINTER(c_double), POINTER(gx_failure)]),
    'gxi_polyhedron_monomials': (c_int, [POINTER(gxi_surface), POINTER(c_double), c_uint, POINTER(c_double), POINTER(c_double), POINTER(gx_failure)]),
    'gxi_surface_flux_monomials': (c_int, [POINTER(gxi_surface), POINTER(c_double), c_uint, POINTER(c_double), POINTER(c_double), POINTER(gx_failure)]),
    'gxi_surface_monomials': (c_int, [POINTER(gxi_surface), POINTER(c_double), c_uint, POINTER(c_double), POINTER(c_double), POINTER(gx_failure)]),
    'gxi_tet_gradients': (c_int, [POINTER(c_double), POINTER(c_double), POINTER(c_double)]),
    'gxi_tet_mass': (None, [c_double, c_double, POINTER(c_double)]),
    'gxi_tet_volume': (c_double, [POINTER(c_double)]),
    'gxi_triangle_area': (c_double, [POINTER(c_double), POINTER(c_double), POINTER(c_double), POINTER(c_double)]),
    'gxs_material_energy': (c_double, [POINTER(gxs_material), POINTER(c_double)]),
    'gxs_material_product': (None, [POINTER(gxs_material), POINTER(c_double), POINTER(c_double), POINTER(c_double)]),
    'gxs_material_stress': (None, [POINTER(gxs_material), POINTER(c_double), POINTER(c_double)]),
    'gxs_solver_create': (c_int, [POINTER(gxs_solver_desc), POINTER(POINTER(gxs_solver)), POINTER(gx_failure)]),
    'gxs_solver_destroy': (None, [POINTER(gxs_solver)]),
    'gxs_solver_linearise': (c_int, [POINTER(gxs_solver), POINTER(c_double), c_double, c_uint32, POINTER(gx_failure)]),
    'gxs_solver_note_written': (None, [POINTER(gxs_solver), POINTER(c_uint32), c_size_t, POINTER(c_double), POINTER(c_double), POINTER(c_double)]),
    'gxs_solver_product': (c_int, [POINTER(gxs_solver), POINTER(c_double), POINTER(c_double), POINTER(gx_failure)]),
    'gxs_solver_resume': (None, [POINTER(gxs_solver), POINTER(gxs_scene)]),
    'gxs_solver_scene': (None, [POINTER(gxs_solver), POINTER(gxs_scene)]),
    'gxs_solver_set_model': (c_int, [POINTER(gxs_solver), POINTER(gxs_model), POINTER(gx_failure)]),
    'gxs_solver_step': (c_int, [POINTER(gxs_solver), POINTER(gxs_step_desc), POINTER(c_double), POINTER(c_double), POINTER(gxs_step_report), POINTER(gx_failure)]),
    'gxs_solver_update': (c_int, [POINTER(gxs_solver), POINTER(gxs_change), POINTER(gx_failure)]),
    'gxs_step_check': (c_int, [POINTER(gxs_step_desc), c_size_t, c_uint64, POINTER(gx_failure)]),
}
