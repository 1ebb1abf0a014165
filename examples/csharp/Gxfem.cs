// The interface of gxfem for C# (Unity and others), written by `make bindings` from the headers. Pointers are IntPtr; size_t is
// UIntPtr. The library is found by the name "gxfem". See docs/EMBEDDING.md.
using System;
using System.Runtime.InteropServices;

namespace Gxfem {
    public enum gx_result {
        GX_OK = 0,
        GX_ERROR_ARGUMENT = 1,
        GX_ERROR_MEMORY = 2,
        GX_ERROR_NOT_FINITE = 3,
        GX_ERROR_RANGE = 4,
        GX_ERROR_INDEX = 5,
        GX_ERROR_EMPTY = 6,
        GX_ERROR_INVERTED = 7,
        GX_ERROR_FLAT = 8,
        GX_ERROR_OVERLAP = 9,
        GX_ERROR_NOT_CLOSED = 10,
        GX_ERROR_LIMIT = 11,
        GX_ERROR_DIVERGED = 12,
        GX_ERROR_FREE = 13,
        GX_ERROR_FORMAT = 14,
        GX_ERROR_DAMAGED = 15,
        GX_ERROR_STALE = 16,
        GX_ERROR_CONFIGURATION = 17,
        GX_ERROR_SEQUENCE = 18,
        GX_ERROR_CAPACITY = 19,
    }

    [StructLayout(LayoutKind.Sequential)]
    public unsafe struct gx_failure {
        public gx_result result;
        public IntPtr field;
        public UIntPtr index;
        public UIntPtr surface;
    }

    [StructLayout(LayoutKind.Sequential)]
    public unsafe struct gx_allocator {
        public IntPtr allocate;
        public IntPtr release;
        public IntPtr user;
        public IntPtr reallocate;
    }

    [StructLayout(LayoutKind.Sequential)]
    public unsafe struct gx_jobs {
        public IntPtr parallel_for;
        public IntPtr user;
    }

    public enum gxs_material_kind {
        GXS_STABLE_NEO_HOOKEAN = 0,
        GXS_ST_VENANT_KIRCHHOFF = 1,
        GXS_FIXED_COROTATED = 2,
        GXS_LINEAR = 3,
        GXS_CUSTOM = 4,
    }

    [StructLayout(LayoutKind.Sequential)]
    public unsafe struct gxs_material {
        public gxs_material_kind kind;
        public double young;
        public double poisson;
        public double damping;
        public IntPtr energy;
        public IntPtr user;
    }

    [StructLayout(LayoutKind.Sequential)]
    public unsafe struct gxs_element {
        public fixed uint copy[4];
        public fixed double gradient[12];
        public double weight;
        public fixed double mass[10];
        public uint material;
        public uint group;
    }

    [StructLayout(LayoutKind.Sequential)]
    public unsafe struct gxs_constraint {
        public uint copy;
        public fixed uint master[4];
        public fixed double weight[4];
    }

    [StructLayout(LayoutKind.Sequential)]
    public unsafe struct gxs_model {
        public UIntPtr copy_count;
        public IntPtr positions;
        public IntPtr elements;
        public UIntPtr element_count;
        public IntPtr materials;
        public UIntPtr material_count;
        public IntPtr held;
        public uint lumped_mass;
        public IntPtr constraints;
        public UIntPtr constraint_count;
        public ulong epoch;
        public IntPtr affine;
        public double affine_length;
    }

    [StructLayout(LayoutKind.Sequential)]
    public unsafe struct gxs_change {
        public UIntPtr copy_count;
        public IntPtr origins;
        public IntPtr held;
        public IntPtr groups;
        public UIntPtr group_count;
        public IntPtr elements;
        public UIntPtr element_count;
        public IntPtr constraints;
        public UIntPtr constraint_count;
        public IntPtr affine;
        public ulong epoch;
    }

    public enum gxs_preconditioner {
        GXS_AUTOMATIC = 0,
        GXS_BLOCK_JACOBI = 1,
        GXS_MULTIGRID = 2,
        GXS_VOLUME_RATIO = 3,
    }

    public enum gxs_matrix {
        GXS_MATRIX_FREE = 0,
        GXS_MATRIX_ASSEMBLED = 1,
    }

    [StructLayout(LayoutKind.Sequential)]
    public unsafe struct gxs_solver_desc {
        public gx_allocator allocator;
        public gx_jobs jobs;
        public gxs_preconditioner preconditioner;
        public gxs_matrix matrix;
    }

    public enum gxs_integrator {
        GXS_BDF1 = 0,
        GXS_BDF2 = 1,
        GXS_MIDPOINT = 2,
        GXS_STATIC = 3,
        GXS_EXPLICIT = 4,
    }

    [StructLayout(LayoutKind.Sequential)]
    public unsafe struct gxs_point {
        public uint count;
        public fixed uint copy[4];
        public fixed double weight[4];
        public IntPtr copies;
        public IntPtr weights;
        public fixed double position[3];
        public ulong epoch;
    }

    [StructLayout(LayoutKind.Sequential)]
    public unsafe struct gxs_spring {
        public gxs_point point;
        public fixed double target[3];
        public double stiffness;
    }

    [StructLayout(LayoutKind.Sequential)]
    public unsafe struct gxs_plane {
        public fixed double normal[3];
        public double offset;
        public double stiffness;
        public double friction;
        public double sticking_speed;
    }

    [StructLayout(LayoutKind.Sequential)]
    public unsafe struct gxs_pair {
        public gxs_point point;
        public uint flags;
        public fixed double way[3];
        public fixed double normal[3];
        public double offset;
        public double stiffness;
        public double friction;
        public double sticking_speed;
    }

    [StructLayout(LayoutKind.Sequential)]
    public unsafe struct gxs_step_desc {
        public double dt;
        public fixed double gravity[3];
        public IntPtr forces;
        public gxs_integrator integrator;
        public IntPtr previous_displacement;
        public IntPtr previous_velocity;
        public double previous_dt;
        public IntPtr targets;
        public ulong epoch;
        public double mass_damping;
        public uint substeps;
        public uint newton_iterations;
        public uint quick;
        public double newton_tolerance;
        public uint cg_iterations;
        public double cg_tolerance;
        public IntPtr springs;
        public UIntPtr spring_count;
        public IntPtr spring_forces;
        public IntPtr points;
        public UIntPtr point_count;
        public IntPtr planes;
        public UIntPtr plane_count;
        public IntPtr contact;
        public IntPtr contact_user;
        public IntPtr pairs;
        public UIntPtr pair_count;
        public IntPtr pair_slips;
        public IntPtr pair_forces;
        public double sleep_speed;
        public double sleep_time;
        public IntPtr rest_times;
        public IntPtr clock;
        public IntPtr clock_user;
        public double budget_seconds;
        public double quality;
    }

    public enum gxs_stop {
        GXS_STOP_BALANCE = 0,
        GXS_STOP_ITERATIONS = 1,
        GXS_STOP_SECONDS = 2,
        GXS_STOP_ROUNDING = 3,
        GXS_STOP_ASLEEP = 4,
    }

    [StructLayout(LayoutKind.Sequential)]
    public unsafe struct gxs_step_report {
        public gxs_stop stop;
        public UIntPtr active_unknowns;
        public uint substeps;
        public uint quick;
        public uint parts;
        public gxs_integrator integrator;
        public double error;
        public uint newton_iterations;
        public uint cg_iterations;
        public uint line_search_steps;
        public double residual;
        public double energy;
        public gxs_preconditioner preconditioner;
        public double seconds;
        public double seconds_linearise;
        public double seconds_prepare;
        public double seconds_solve;
    }

    [StructLayout(LayoutKind.Sequential)]
    public unsafe struct gxs_scene {
        public fixed double gravity[3];
        public ulong planes;
        public ulong forces;
        public ulong springs;
    }

    [StructLayout(LayoutKind.Sequential)]
    public unsafe struct gx_material {
        public gxs_material elastic;
        public double density;
    }

    [StructLayout(LayoutKind.Sequential)]
    public unsafe struct gx_surface {
        public IntPtr vertices;
        public UIntPtr vertex_count;
        public IntPtr triangles;
        public UIntPtr triangle_count;
        public uint kind;
        public IntPtr texture;
        public IntPtr scope_slots;
        public UIntPtr scope_slot_count;
        public uint material;
    }

    [StructLayout(LayoutKind.Sequential)]
    public unsafe struct gx_shape {
        public IntPtr surfaces;
        public UIntPtr surface_count;
        public uint cells;
        public double edge;
        public UIntPtr unknowns;
    }

    [StructLayout(LayoutKind.Sequential)]
    public unsafe struct gx_body_desc {
        public IntPtr positions;
        public UIntPtr node_count;
        public IntPtr elements;
        public UIntPtr element_count;
        public double young;
        public double poisson;
        public double density;
        public IntPtr materials;
        public UIntPtr material_count;
        public IntPtr element_materials;
        public IntPtr texture;
        public double support_below;
        public double affine_below;
        public gx_allocator allocator;
        public IntPtr clock;
        public IntPtr clock_user;
        public gx_jobs jobs;
        public IntPtr shape;
    }

    [StructLayout(LayoutKind.Sequential)]
    public unsafe struct gx_cut_desc {
        public IntPtr surfaces;
        public UIntPtr surface_count;
        public IntPtr scope_fragments;
        public UIntPtr scope_fragment_count;
        public IntPtr scope_cells;
        public UIntPtr scope_cell_count;
        public double sever_below;
        public IntPtr release;
        public UIntPtr release_count;
    }

    [StructLayout(LayoutKind.Sequential)]
    public unsafe struct gx_cut_report {
        public UIntPtr touched_elements;
        public UIntPtr created_cells;
        public UIntPtr removed_cells;
        public UIntPtr created_copies;
        public UIntPtr removed_copies;
        public UIntPtr ignored_triangles;
        public UIntPtr severed_links;
        public double min_link_ratio;
        public double removed_volume;
        public double seconds_arrangement;
        public double seconds_enrichment;
        public double seconds_integrals;
    }

    [StructLayout(LayoutKind.Sequential)]
    public unsafe struct gx_view {
        public UIntPtr node_count;
        public UIntPtr element_count;
        public UIntPtr cell_count;
        public IntPtr cell_element;
        public IntPtr cell_copies;
        public IntPtr cell_volume;
        public IntPtr cell_fragment;
        public IntPtr cell_slot;
        public UIntPtr slot_count;
        public IntPtr slot_parent;
        public UIntPtr copy_count;
        public IntPtr copy_node;
        public IntPtr copy_held;
        public IntPtr copy_region;
        public ulong epoch;
        public IntPtr displacement;
        public IntPtr velocity;
        public IntPtr rest_time;
        public UIntPtr fragment_count;
        public IntPtr fragment_volume;
        public IntPtr fragment_mass;
        public IntPtr fragment_center;
        public IntPtr fragment_inertia;
        public IntPtr fragment_id;
        public IntPtr fragment_origin;
        public IntPtr fragment_change;
        public UIntPtr removed_count;
        public IntPtr removed_ids;
        public double volume;
        public double mass;
        public IntPtr copy_affine;
        public IntPtr affine;
        public IntPtr affine_rate;
        public IntPtr positions;
        public IntPtr elements;
        public IntPtr cell_material;
    }

    [StructLayout(LayoutKind.Sequential)]
    public unsafe struct gx_motion {
        public double mass;
        public fixed double center[3];
        public fixed double inertia[6];
        public fixed double velocity[3];
        public fixed double angular_velocity[3];
        public double energy;
    }

    [StructLayout(LayoutKind.Sequential)]
    public unsafe struct gx_anchor {
        public uint element;
        public fixed double position[3];
        public fixed double toward[3];
    }

    [StructLayout(LayoutKind.Sequential)]
    public unsafe struct gx_region {
        public uint axis;
        public int side;
        public double value;
        public uint kind;
        public fixed double low[3];
        public fixed double high[3];
        public fixed double center[3];
        public double radius;
        public IntPtr surface;
        public IntPtr nodes;
        public UIntPtr node_count;
        public IntPtr anchors;
        public UIntPtr anchor_count;
    }

    [StructLayout(LayoutKind.Sequential)]
    public unsafe struct gx_collider {
        public uint id;
        public uint kind;
        public fixed double size[3];
        public fixed double pose[12];
        public fixed double velocity[3];
        public fixed double spin[3];
        public double friction;
        public IntPtr distance;
        public IntPtr user;
    }

    [StructLayout(LayoutKind.Sequential)]
    public unsafe struct gx_collider_load {
        public fixed double force[3];
        public fixed double torque[3];
        public fixed double stiffness[36];
        public uint contacts;
    }

    [StructLayout(LayoutKind.Sequential)]
    public unsafe struct gx_step_desc {
        public double dt;
        public fixed double gravity[3];
        public gxs_integrator integrator;
        public uint substeps;
        public uint quick;
        public uint newton_iterations;
        public double newton_tolerance;
        public uint cg_iterations;
        public double cg_tolerance;
        public double mass_damping;
        public IntPtr forces;
        public IntPtr targets;
        public IntPtr region_poses;
        public ulong epoch;
        public IntPtr springs;
        public UIntPtr spring_count;
        public IntPtr spring_anchors;
        public IntPtr spring_forces;
        public IntPtr points;
        public UIntPtr point_count;
        public IntPtr point_anchors;
        public IntPtr force_anchors;
        public IntPtr anchor_forces;
        public UIntPtr force_count;
        public IntPtr planes;
        public UIntPtr plane_count;
        public IntPtr contact;
        public IntPtr contact_user;
        public IntPtr pairs;
        public UIntPtr pair_count;
        public IntPtr pair_anchors;
        public IntPtr pair_slips;
        public IntPtr pair_forces;
        public IntPtr colliders;
        public UIntPtr collider_count;
        public IntPtr collider_loads;
        public IntPtr contact_filter;
        public IntPtr contact_filter_user;
        public double sleep_speed;
        public double sleep_time;
        public IntPtr clock;
        public IntPtr clock_user;
        public double budget_seconds;
        public double quality;
    }

    [StructLayout(LayoutKind.Sequential)]
    public unsafe struct gx_contact_desc {
        public double stiffness;
        public double friction;
        public double sticking_speed;
        public double recovery;
        public double depth;
        public uint max_pairs;
    }

    [StructLayout(LayoutKind.Sequential)]
    public unsafe struct gx_contact {
        public uint fragment;
        public uint other;
        public uint collider;
        public fixed double position[3];
        public fixed double normal[3];
        public fixed double force[3];
        public double depth;
    }

    [StructLayout(LayoutKind.Sequential)]
    public unsafe struct gx_contact_event {
        public uint change;
        public uint fragment;
        public uint other;
        public uint collider;
        public uint contacts;
        public fixed double force[3];
        public double load;
        public fixed double position[3];
        public fixed double normal[3];
    }

    [StructLayout(LayoutKind.Sequential)]
    public unsafe struct gx_group_contact {
        public uint body;
        public uint other_body;
        public gx_contact contact;
    }

    [StructLayout(LayoutKind.Sequential)]
    public unsafe struct gx_group_contact_event {
        public uint body;
        public uint other_body;
        public gx_contact_event @event;
    }

    [StructLayout(LayoutKind.Sequential)]
    public unsafe struct gx_skin_desc {
        public double crease_angle;
        public int smooth_cuts;
    }

    [StructLayout(LayoutKind.Sequential)]
    public unsafe struct gx_range {
        public uint first;
        public uint count;
    }

    [StructLayout(LayoutKind.Sequential)]
    public unsafe struct gx_skin {
        public UIntPtr vertex_count;
        public uint vertex_width;
        public IntPtr vertex_copies;
        public IntPtr vertex_weights;
        public IntPtr vertex_point;
        public IntPtr vertex_rest;
        public IntPtr vertex_normal;
        public IntPtr vertex_texture;
        public UIntPtr triangle_count;
        public IntPtr triangles;
        public IntPtr triangle_fragment;
        public IntPtr triangle_element;
        public IntPtr triangle_material;
        public IntPtr triangle_surface;
        public IntPtr vertex_ranges;
        public UIntPtr vertex_range_count;
        public IntPtr triangle_ranges;
        public UIntPtr triangle_range_count;
        public ulong epoch;
    }

    [StructLayout(LayoutKind.Sequential)]
    public unsafe struct gx_hit {
        public uint triangle;
        public uint fragment;
        public uint element;
        public uint surface;
        public uint cell;
        public uint slot;
        public uint slot_count;
        public double distance;
        public fixed double position[3];
        public fixed double material[3];
        public uint copy_count;
        public fixed uint copies[16];
        public fixed double weights[16];
        public ulong epoch;
    }

    [StructLayout(LayoutKind.Sequential)]
    public unsafe struct gx_blade_desc {
        public double tolerance;
        public double min_advance;
        public uint max_samples;
        public int starts_inside;
    }

    [StructLayout(LayoutKind.Sequential)]
    public unsafe struct gx_blade_report {
        public UIntPtr layer_count;
        public UIntPtr triangle_count;
        public double deviation;
        public gx_cut_report cut;
    }

    [StructLayout(LayoutKind.Sequential)]
    public unsafe struct gx_blade_contact {
        public gx_hit hit;
        public double along;
        public double length;
    }

    [StructLayout(LayoutKind.Sequential)]
    public unsafe struct gxb_num {
        public int sign;
        public int exp;
        public uint n;
        public IntPtr d;
    }

    [StructLayout(LayoutKind.Sequential)]
    public unsafe struct gxb_fixed {
        public fixed ulong d[3];
    }

    [StructLayout(LayoutKind.Sequential)]
    public unsafe struct gxb_plane_filter {
        public fixed double n[3];
        public fixed double @base[3];
        public double base_error;
        public double error;
        public double norm;
    }

    [StructLayout(LayoutKind.Sequential)]
    public unsafe struct gxb_ball {
        public fixed double x[3];
        public double error;
    }

    [StructLayout(LayoutKind.Sequential)]
    public unsafe struct gxb_plane {
        public gxb_plane_filter filter;
        public IntPtr p;
        public IntPtr q;
        public IntPtr r;
    }

    [StructLayout(LayoutKind.Sequential)]
    public unsafe struct gxb_point {
        public gxb_ball ball;
        public IntPtr p;
        public IntPtr q;
        public IntPtr plane0, plane1, plane2;
    }

    [StructLayout(LayoutKind.Sequential)]
    public unsafe struct gxb_cpoint {
        public gxb_ball ball;
        public fixed uint def[3];
        public byte kind;
        public byte wall;
        public fixed sbyte sign[2];
        public fixed uint stamp[2];
        public IntPtr exact;
        public fixed double parameter[3];
        public uint rim_edge;
        public uint name;
    }

    [StructLayout(LayoutKind.Sequential)]
    public unsafe struct gxb_cplane {
        public gxb_plane_filter filter;
        public IntPtr exact;
        public fixed uint def[3];
        public byte along_axis;
        public byte axis;
        public sbyte axis_sign;
    }

    [StructLayout(LayoutKind.Sequential)]
    public unsafe struct gxb_edge {
        public fixed uint v[2];
        public fixed uint line[2];
        public uint child;
        public uint bits20; // from the lowest: explicit_line, wall, stamp
    }

    [StructLayout(LayoutKind.Sequential)]
    public unsafe struct gxb_facet {
        public uint plane;
        public uint loop;
        public uint bits8; // from the lowest: loop_count, wall
        public fixed uint leaf[2];
        public uint child;
        public uint labels;
        public uint face;
    }

    [StructLayout(LayoutKind.Sequential)]
    public unsafe struct gxb_label {
        public uint triangle;
        public int orientation;
        public uint next;
    }

    [StructLayout(LayoutKind.Sequential)]
    public unsafe struct gxb_leaf {
        public uint element;
        public uint facets;
        public uint facet_count;
        public uint parent;
        public uint removed;
    }

    [StructLayout(LayoutKind.Sequential)]
    public unsafe struct gxb_node {
        public uint plane;
        public fixed uint child[2];
        public uint parent;
        public uint leaves;
        public uint facet;
    }

    [StructLayout(LayoutKind.Sequential)]
    public unsafe struct gxb_block {
        public IntPtr next;
        public UIntPtr size;
        public UIntPtr used;
    }

    [StructLayout(LayoutKind.Sequential)]
    public unsafe struct gxb_triangle {
        public fixed uint point[3];
        public uint plane;
        public int orientation;
        public fixed uint edge_plane[3];
        public uint label;
        public uint wall;
    }

    [StructLayout(LayoutKind.Sequential)]
    public unsafe struct gxb_mesh {
        public IntPtr positions;
        public UIntPtr node_count;
        public IntPtr elements;
        public UIntPtr element_count;
    }

    [StructLayout(LayoutKind.Sequential)]
    public unsafe struct gxb_undo {
        public uint array;
        public uint index;
    }

    [StructLayout(LayoutKind.Sequential)]
    public unsafe struct gxb_store {
        public IntPtr points;
        public uint point_count;
        public uint point_capacity;
        public IntPtr planes;
        public uint plane_count;
        public uint plane_capacity;
        public fixed uint stamp[2];
        public int shift;
        public fixed double origin[3];
        public IntPtr blocks;
        public fixed uint mark[2];
        public uint next_name;
        public uint mark_name;
        public IntPtr mark_block;
        public UIntPtr mark_used;
        public IntPtr undo;
        public uint undo_count;
        public uint undo_capacity;
        public IntPtr undo_bytes;
        public uint undo_byte_count;
        public uint undo_byte_capacity;
        public ulong filter_calls;
        public ulong exact_calls;
        public gx_allocator allocator;
    }

    [StructLayout(LayoutKind.Sequential)]
    public unsafe struct gxb_complex {
        public gxb_store store;
        public IntPtr edges;
        public uint edge_count;
        public uint edge_capacity;
        public IntPtr facets;
        public uint facet_count;
        public uint facet_capacity;
        public IntPtr leaves;
        public uint leaf_count;
        public uint leaf_capacity;
        public IntPtr nodes;
        public uint tree_count;
        public uint tree_capacity;
        public IntPtr pool;
        public uint pool_count;
        public uint pool_capacity;
        public IntPtr elements;
        public IntPtr element_faces;
        public IntPtr element_edges;
        public IntPtr face_elements;
        public IntPtr face_facet;
        public IntPtr mesh_edge;
        public IntPtr root;
        public uint node_count;
        public uint element_count;
        public uint face_count;
        public uint mesh_edge_count;
        public uint pool_live;
        public uint mark_live;
        public uint removed_count;
        public uint mark_removed;
        public ulong settled;
        public IntPtr labels;
        public uint label_count;
        public uint label_capacity;
        public IntPtr marked;
        public uint marked_count;
        public uint marked_capacity;
        public IntPtr corners;
        public uint corner_count;
        public uint corner_capacity;
        public IntPtr tasks;
        public uint task_count;
        public uint task_capacity;
        public IntPtr leaf_facets;
        public uint leaf_facet_count;
        public uint leaf_facet_capacity;
        public IntPtr leaf_signs;
        public uint leaf_sign_count;
        public uint leaf_sign_capacity;
        public IntPtr rim;
        public uint rim_count;
        public uint rim_capacity;
        public IntPtr front_facets;
        public uint front_facet_count;
        public uint front_facet_capacity;
        public IntPtr behind_facets;
        public uint behind_facet_count;
        public uint behind_facet_capacity;
        public IntPtr loop;
        public uint loop_count;
        public uint loop_capacity;
        public IntPtr inner_facets;
        public uint inner_facet_count;
        public uint inner_facet_capacity;
        public fixed uint mark[6];
        public uint edge_stamp;
        public uint sign_plane;
        public IntPtr pairs;
    }

    [StructLayout(LayoutKind.Sequential)]
    public unsafe struct gxb_renumbering {
        public IntPtr leaves;
        public IntPtr planes;
        public uint leaf_count;
        public uint plane_count;
        public IntPtr leaf_of;
        public IntPtr changed;
        public int renamed;
        public IntPtr memory;
        public UIntPtr size;
    }

    [StructLayout(LayoutKind.Sequential)]
    public unsafe struct gxb_pullback {
        public IntPtr corners;
        public IntPtr point;
        public fixed double d[4];
        public double error;
        public fixed sbyte sign[4];
        public sbyte orientation;
    }

    [StructLayout(LayoutKind.Sequential)]
    public unsafe struct gxb_stream {
        public IntPtr @out;
        public IntPtr @in;
        public UIntPtr size;
        public UIntPtr at;
        public gx_result result;
    }

    [StructLayout(LayoutKind.Sequential)]
    public unsafe struct gxb_operand {
        public IntPtr vertices;
        public UIntPtr vertex_count;
        public IntPtr triangles;
        public UIntPtr triangle_count;
        public uint operation;
        public uint rule;
        public uint simple;
    }

    [StructLayout(LayoutKind.Sequential)]
    public unsafe struct gxb_boolean_desc {
        public gx_allocator allocator;
        public UIntPtr memory_limit;
        public IntPtr inside;
        public IntPtr user;
        public gx_jobs jobs;
    }

    [StructLayout(LayoutKind.Sequential)]
    public unsafe struct gxb_origin {
        public uint kind;
        public fixed uint operand[3];
        public fixed uint index[3];
    }

    [StructLayout(LayoutKind.Sequential)]
    public unsafe struct gxb_boolean_result {
        public IntPtr vertices;
        public UIntPtr vertex_count;
        public IntPtr triangles;
        public UIntPtr triangle_count;
        public IntPtr vertex_origin;
        public IntPtr triangle_operand;
        public IntPtr triangle_source;
        public IntPtr triangle_reversed;
    }

    [StructLayout(LayoutKind.Sequential)]
    public unsafe struct gxb_range {
        public UIntPtr first;
        public UIntPtr count;
    }

    [StructLayout(LayoutKind.Sequential)]
    public unsafe struct gxb_changes {
        public IntPtr vertices;
        public UIntPtr vertex_range_count;
        public IntPtr triangles;
        public UIntPtr triangle_range_count;
    }

    [StructLayout(LayoutKind.Sequential)]
    public unsafe struct gxb_components {
        public UIntPtr count;
        public IntPtr volume;
        public IntPtr euler;
        public IntPtr side;
        public IntPtr triangle;
        public double total_volume;
    }

    [StructLayout(LayoutKind.Sequential)]
    public unsafe struct gxb_defects {
        public IntPtr triangles;
        public UIntPtr count;
        public UIntPtr mended_count;
    }

    [StructLayout(LayoutKind.Sequential)]
    public unsafe struct gxb_statistics {
        public ulong filter_calls;
        public ulong exact_calls;
        public ulong allocations;
        public UIntPtr peak_bytes;
    }

    [StructLayout(LayoutKind.Sequential)]
    public unsafe struct gxi_surface {
        public IntPtr positions;
        public UIntPtr position_count;
        public IntPtr triangles;
        public UIntPtr triangle_count;
    }

    [StructLayout(LayoutKind.Sequential)]
    public unsafe struct gxi_moments2 {
        public double volume;
        public fixed double first[3];
        public fixed double second[6];
    }

    public static class Native {
        public const uint GXS_PAIR_OUTSIDE = 1;
        public const uint GXS_PAIR_WAKES = 2;
        public const uint GX_SURFACE_SHEET = 0;
        public const uint GX_SURFACE_SOLID = 1;
        public const uint GX_SURFACE_KEEP = 2;
        public const uint GX_SURFACE_MATERIAL = 3;
        public const uint GX_FRAGMENT_UNCHANGED = 0;
        public const uint GX_FRAGMENT_TOUCHED = 1;
        public const uint GX_FRAGMENT_SPLIT = 2;
        public const uint GX_FRAGMENT_CREATED = 3;
        public const uint GX_REGION_HALF_SPACE = 0;
        public const uint GX_REGION_BOX = 1;
        public const uint GX_REGION_SPHERE = 2;
        public const uint GX_REGION_SURFACE = 3;
        public const uint GX_REGION_NODES = 4;
        public const uint GX_REGION_ANCHORS = 5;
        public const uint GX_COLLIDER_PLANE = 0;
        public const uint GX_COLLIDER_SPHERE = 1;
        public const uint GX_COLLIDER_CAPSULE = 2;
        public const uint GX_COLLIDER_BOX = 3;
        public const uint GX_COLLIDER_DISTANCE = 4;
        public const uint GX_CONTACT_BEGAN = 0;
        public const uint GX_CONTACT_PERSISTS = 1;
        public const uint GX_CONTACT_ENDED = 2;
        public const uint GX_SKIN_OUTER = 0;
        public const uint GXB_EXPLICIT = 0;
        public const uint GXB_LINE_PLANE = 1;
        public const uint GXB_THREE_PLANES = 2;
        public const uint GXB_UNION = 0;
        public const uint GXB_INTERSECTION = 1;
        public const uint GXB_DIFFERENCE = 2;
        public const uint GXB_SYMMETRIC_DIFFERENCE = 3;
        public const uint GXB_SPLIT = 4;
        public const uint GXB_NONZERO = 0;
        public const uint GXB_POSITIVE = 1;
        public const uint GXB_NEGATIVE = 2;
        public const uint GXB_ODD = 3;
        public const uint GXB_DIVIDED = 0;
        public const uint GXB_COARSE = 1;
        public const uint GXB_MERGED = 2;
        public const uint GXB_FROM_VERTEX = 0;
        public const uint GXB_FROM_EDGE_TRIANGLE = 1;
        public const uint GXB_FROM_EDGE_EDGE = 2;
        public const uint GXB_FROM_THREE_TRIANGLES = 3;

        [DllImport("gxfem", CallingConvention = CallingConvention.Cdecl)]
        public static extern gx_result gx_blade_contacts(IntPtr blade, IntPtr contacts, UIntPtr capacity, IntPtr count, IntPtr failure);

        [DllImport("gxfem", CallingConvention = CallingConvention.Cdecl)]
        public static extern gx_result gx_blade_create(IntPtr body, IntPtr desc, IntPtr blade, IntPtr failure);

        [DllImport("gxfem", CallingConvention = CallingConvention.Cdecl)]
        public static extern void gx_blade_destroy(IntPtr blade);

        [DllImport("gxfem", CallingConvention = CallingConvention.Cdecl)]
        public static extern gx_result gx_blade_lift(IntPtr blade, IntPtr report, IntPtr failure);

        [DllImport("gxfem", CallingConvention = CallingConvention.Cdecl)]
        public static extern gx_result gx_blade_move(IntPtr blade, IntPtr edge, UIntPtr point_count, IntPtr scope_fragments, UIntPtr scope_fragment_count, IntPtr report, IntPtr failure);

        [DllImport("gxfem", CallingConvention = CallingConvention.Cdecl)]
        public static extern gx_result gx_body_anchor(IntPtr body, uint element, IntPtr material, IntPtr anchor, IntPtr failure);

        [DllImport("gxfem", CallingConvention = CallingConvention.Cdecl)]
        public static extern gx_result gx_body_anchor_point(IntPtr body, IntPtr anchor, IntPtr point, IntPtr position, IntPtr failure);

        [DllImport("gxfem", CallingConvention = CallingConvention.Cdecl)]
        public static extern IntPtr gx_body_blade(IntPtr body, UIntPtr index);

        [DllImport("gxfem", CallingConvention = CallingConvention.Cdecl)]
        public static extern gx_result gx_body_carve(IntPtr body, IntPtr tool, IntPtr report, IntPtr failure);

        [DllImport("gxfem", CallingConvention = CallingConvention.Cdecl)]
        public static extern gx_result gx_body_clone(IntPtr body, IntPtr clone, IntPtr failure);

        [DllImport("gxfem", CallingConvention = CallingConvention.Cdecl)]
        public static extern gx_result gx_body_contact(IntPtr body, IntPtr desc, IntPtr failure);

        [DllImport("gxfem", CallingConvention = CallingConvention.Cdecl)]
        public static extern gx_result gx_body_contact_events(IntPtr body, IntPtr events, UIntPtr capacity, IntPtr count, IntPtr failure);

        [DllImport("gxfem", CallingConvention = CallingConvention.Cdecl)]
        public static extern gx_result gx_body_contacts(IntPtr body, IntPtr contacts, UIntPtr capacity, IntPtr count, IntPtr failure);

        [DllImport("gxfem", CallingConvention = CallingConvention.Cdecl)]
        public static extern gx_result gx_body_create(IntPtr desc, IntPtr body, IntPtr failure);

        [DllImport("gxfem", CallingConvention = CallingConvention.Cdecl)]
        public static extern gx_result gx_body_cut(IntPtr body, IntPtr desc, IntPtr report, IntPtr failure);

        [DllImport("gxfem", CallingConvention = CallingConvention.Cdecl)]
        public static extern void gx_body_destroy(IntPtr body);

        [DllImport("gxfem", CallingConvention = CallingConvention.Cdecl)]
        public static extern gx_result gx_body_hold(IntPtr body, IntPtr regions, UIntPtr region_count, IntPtr failure);

        [DllImport("gxfem", CallingConvention = CallingConvention.Cdecl)]
        public static extern gx_result gx_body_load(IntPtr memory, UIntPtr size, IntPtr desc, IntPtr body, IntPtr failure);

        [DllImport("gxfem", CallingConvention = CallingConvention.Cdecl)]
        public static extern gx_result gx_body_locate(IntPtr body, IntPtr points, UIntPtr count, IntPtr hits, IntPtr failure);

        [DllImport("gxfem", CallingConvention = CallingConvention.Cdecl)]
        public static extern gx_result gx_body_locate_all(IntPtr body, IntPtr point, IntPtr hits, UIntPtr capacity, IntPtr count, IntPtr failure);

        [DllImport("gxfem", CallingConvention = CallingConvention.Cdecl)]
        public static extern gx_result gx_body_lost_anchors(IntPtr body, IntPtr anchors, UIntPtr count, IntPtr lost, IntPtr failure);

        [DllImport("gxfem", CallingConvention = CallingConvention.Cdecl)]
        public static extern gx_result gx_body_model(IntPtr body, IntPtr model, IntPtr failure);

        [DllImport("gxfem", CallingConvention = CallingConvention.Cdecl)]
        public static extern gx_result gx_body_motion(IntPtr body, IntPtr motions, UIntPtr capacity, IntPtr failure);

        [DllImport("gxfem", CallingConvention = CallingConvention.Cdecl)]
        public static extern gx_result gx_body_pick(IntPtr body, IntPtr origin, IntPtr direction, IntPtr hit, IntPtr failure);

        [DllImport("gxfem", CallingConvention = CallingConvention.Cdecl)]
        public static extern gx_result gx_body_place(IntPtr body, uint slot, IntPtr material, IntPtr position, IntPtr failure);

        [DllImport("gxfem", CallingConvention = CallingConvention.Cdecl)]
        public static extern gx_result gx_body_restore(IntPtr body, IntPtr from, IntPtr failure);

        [DllImport("gxfem", CallingConvention = CallingConvention.Cdecl)]
        public static extern gx_result gx_body_save(IntPtr body, IntPtr memory, UIntPtr capacity, IntPtr size, IntPtr failure);

        [DllImport("gxfem", CallingConvention = CallingConvention.Cdecl)]
        public static extern gx_result gx_body_skin(IntPtr body, IntPtr desc, IntPtr skin, IntPtr failure);

        [DllImport("gxfem", CallingConvention = CallingConvention.Cdecl)]
        public static extern gx_result gx_body_skin_positions(IntPtr body, IntPtr positions, IntPtr failure);

        [DllImport("gxfem", CallingConvention = CallingConvention.Cdecl)]
        public static extern gx_result gx_body_skin_vertices(IntPtr body, IntPtr origin, IntPtr positions, IntPtr normals, IntPtr failure);

        [DllImport("gxfem", CallingConvention = CallingConvention.Cdecl)]
        public static extern ulong gx_body_state_hash(IntPtr body);

        [DllImport("gxfem", CallingConvention = CallingConvention.Cdecl)]
        public static extern gx_result gx_body_step(IntPtr body, IntPtr desc, IntPtr report, IntPtr failure);

        [DllImport("gxfem", CallingConvention = CallingConvention.Cdecl)]
        public static extern ulong gx_body_topology_hash(IntPtr body, IntPtr failure);

        [DllImport("gxfem", CallingConvention = CallingConvention.Cdecl)]
        public static extern gx_result gx_body_view(IntPtr body, IntPtr view, IntPtr failure);

        [DllImport("gxfem", CallingConvention = CallingConvention.Cdecl)]
        public static extern gx_result gx_group_contact_events(IntPtr group, IntPtr events, UIntPtr capacity, IntPtr count, IntPtr failure);

        [DllImport("gxfem", CallingConvention = CallingConvention.Cdecl)]
        public static extern gx_result gx_group_contacts(IntPtr group, IntPtr contacts, UIntPtr capacity, IntPtr count, IntPtr failure);

        [DllImport("gxfem", CallingConvention = CallingConvention.Cdecl)]
        public static extern gx_result gx_group_create(IntPtr bodies, UIntPtr body_count, IntPtr group, IntPtr failure);

        [DllImport("gxfem", CallingConvention = CallingConvention.Cdecl)]
        public static extern void gx_group_destroy(IntPtr group);

        [DllImport("gxfem", CallingConvention = CallingConvention.Cdecl)]
        public static extern gx_result gx_group_step(IntPtr group, IntPtr steps, IntPtr report, IntPtr failure);

        [DllImport("gxfem", CallingConvention = CallingConvention.Cdecl)]
        public static extern gx_result gx_hit_anchor(IntPtr body, IntPtr hit, IntPtr anchor, IntPtr failure);

        [DllImport("gxfem", CallingConvention = CallingConvention.Cdecl)]
        public static extern gxs_point gx_hit_point(IntPtr hit);

        [DllImport("gxfem", CallingConvention = CallingConvention.Cdecl)]
        public static extern gx_region gx_region_box(IntPtr low, IntPtr high);

        [DllImport("gxfem", CallingConvention = CallingConvention.Cdecl)]
        public static extern gx_region gx_region_half_space(uint axis, int side, double value);

        [DllImport("gxfem", CallingConvention = CallingConvention.Cdecl)]
        public static extern gx_region gx_region_sphere(IntPtr center, double radius);

        [DllImport("gxfem", CallingConvention = CallingConvention.Cdecl)]
        public static extern IntPtr gx_result_text(gx_result result);

        [DllImport("gxfem", CallingConvention = CallingConvention.Cdecl)]
        public static extern gxs_point gx_skin_point(IntPtr skin, uint vertex);

        [DllImport("gxfem", CallingConvention = CallingConvention.Cdecl)]
        public static extern gx_result gx_surface_solidify(IntPtr sheet, double thickness, IntPtr solid_vertices, IntPtr solid_vertex_count, IntPtr solid_triangles, IntPtr solid_triangle_count, IntPtr allocator, IntPtr failure);

        [DllImport("gxfem", CallingConvention = CallingConvention.Cdecl)]
        public static extern gx_result gxb_boolean_add(IntPtr boolean, IntPtr operand, IntPtr failure);

        [DllImport("gxfem", CallingConvention = CallingConvention.Cdecl)]
        public static extern gx_result gxb_boolean_changes(IntPtr boolean, IntPtr changes, IntPtr failure);

        [DllImport("gxfem", CallingConvention = CallingConvention.Cdecl)]
        public static extern gx_result gxb_boolean_components(IntPtr boolean, IntPtr components, IntPtr failure);

        [DllImport("gxfem", CallingConvention = CallingConvention.Cdecl)]
        public static extern gx_result gxb_boolean_create(IntPtr desc, IntPtr boolean, IntPtr failure);

        [DllImport("gxfem", CallingConvention = CallingConvention.Cdecl)]
        public static extern gx_result gxb_boolean_defects(IntPtr boolean, IntPtr defects, IntPtr failure);

        [DllImport("gxfem", CallingConvention = CallingConvention.Cdecl)]
        public static extern void gxb_boolean_destroy(IntPtr boolean);

        [DllImport("gxfem", CallingConvention = CallingConvention.Cdecl)]
        public static extern gx_result gxb_boolean_evaluate(IntPtr boolean, IntPtr result, IntPtr failure);

        [DllImport("gxfem", CallingConvention = CallingConvention.Cdecl)]
        public static extern gx_result gxb_boolean_remove(IntPtr boolean, uint operand, IntPtr failure);

        [DllImport("gxfem", CallingConvention = CallingConvention.Cdecl)]
        public static extern gx_result gxb_boolean_set_fine(IntPtr boolean, int fine, IntPtr failure);

        [DllImport("gxfem", CallingConvention = CallingConvention.Cdecl)]
        public static extern gx_result gxb_boolean_set_mend(IntPtr boolean, int mend, IntPtr failure);

        [DllImport("gxfem", CallingConvention = CallingConvention.Cdecl)]
        public static extern gx_result gxb_boolean_set_retained(IntPtr boolean, int retained, IntPtr failure);

        [DllImport("gxfem", CallingConvention = CallingConvention.Cdecl)]
        public static extern gx_result gxb_boolean_set_triangulation(IntPtr boolean, uint triangulation, IntPtr failure);

        [DllImport("gxfem", CallingConvention = CallingConvention.Cdecl)]
        public static extern gx_result gxb_boolean_statistics(IntPtr boolean, IntPtr statistics, IntPtr failure);

        [DllImport("gxfem", CallingConvention = CallingConvention.Cdecl)]
        public static extern int gxb_compare(IntPtr a, IntPtr b, int axis);

        [DllImport("gxfem", CallingConvention = CallingConvention.Cdecl)]
        public static extern gx_result gxb_complex_add_plane(IntPtr complex, IntPtr triangle);

        [DllImport("gxfem", CallingConvention = CallingConvention.Cdecl)]
        public static extern gx_result gxb_complex_add_point(IntPtr complex, IntPtr x, IntPtr point);

        [DllImport("gxfem", CallingConvention = CallingConvention.Cdecl)]
        public static extern void gxb_complex_barycentric(IntPtr complex, uint point, uint element, IntPtr lambda);

        [DllImport("gxfem", CallingConvention = CallingConvention.Cdecl)]
        public static extern void gxb_complex_barycentric_fine(IntPtr complex, uint point, uint element, IntPtr lambda);

        [DllImport("gxfem", CallingConvention = CallingConvention.Cdecl)]
        public static extern void gxb_complex_barycentric_fixed(IntPtr complex, uint point, uint element, IntPtr lambda);

        [DllImport("gxfem", CallingConvention = CallingConvention.Cdecl)]
        public static extern void gxb_complex_begin(IntPtr complex);

        [DllImport("gxfem", CallingConvention = CallingConvention.Cdecl)]
        public static extern gx_result gxb_complex_check_point(IntPtr complex, IntPtr x);

        [DllImport("gxfem", CallingConvention = CallingConvention.Cdecl)]
        public static extern void gxb_complex_commit(IntPtr complex);

        [DllImport("gxfem", CallingConvention = CallingConvention.Cdecl)]
        public static extern void gxb_complex_compact(IntPtr complex, IntPtr renumbering);

        [DllImport("gxfem", CallingConvention = CallingConvention.Cdecl)]
        public static extern int gxb_complex_compare(IntPtr complex, uint point, int axis, double value);

        [DllImport("gxfem", CallingConvention = CallingConvention.Cdecl)]
        public static extern gx_result gxb_complex_cover_edge(IntPtr complex, IntPtr triangle, uint element, uint local_edge, IntPtr covered);

        [DllImport("gxfem", CallingConvention = CallingConvention.Cdecl)]
        public static extern gx_result gxb_complex_cover_node(IntPtr complex, IntPtr triangle, uint node, IntPtr covered);

        [DllImport("gxfem", CallingConvention = CallingConvention.Cdecl)]
        public static extern gx_result gxb_complex_create(IntPtr mesh, IntPtr allocator, IntPtr complex, IntPtr failure);

        [DllImport("gxfem", CallingConvention = CallingConvention.Cdecl)]
        public static extern void gxb_complex_destroy(IntPtr complex);

        [DllImport("gxfem", CallingConvention = CallingConvention.Cdecl)]
        public static extern IntPtr gxb_complex_edge(IntPtr complex, uint edge);

        [DllImport("gxfem", CallingConvention = CallingConvention.Cdecl)]
        public static extern uint gxb_complex_edge_start(IntPtr complex, uint signed_edge);

        [DllImport("gxfem", CallingConvention = CallingConvention.Cdecl)]
        public static extern uint gxb_complex_element_count(IntPtr complex);

        [DllImport("gxfem", CallingConvention = CallingConvention.Cdecl)]
        public static extern IntPtr gxb_complex_element_edges(IntPtr complex, uint element);

        [DllImport("gxfem", CallingConvention = CallingConvention.Cdecl)]
        public static extern IntPtr gxb_complex_element_faces(IntPtr complex, uint element);

        [DllImport("gxfem", CallingConvention = CallingConvention.Cdecl)]
        public static extern IntPtr gxb_complex_element_nodes(IntPtr complex, uint element);

        [DllImport("gxfem", CallingConvention = CallingConvention.Cdecl)]
        public static extern uint gxb_complex_face_count(IntPtr complex);

        [DllImport("gxfem", CallingConvention = CallingConvention.Cdecl)]
        public static extern IntPtr gxb_complex_face_elements(IntPtr complex, uint face);

        [DllImport("gxfem", CallingConvention = CallingConvention.Cdecl)]
        public static extern uint gxb_complex_face_facet(IntPtr complex, uint face);

        [DllImport("gxfem", CallingConvention = CallingConvention.Cdecl)]
        public static extern IntPtr gxb_complex_facet(IntPtr complex, uint facet);

        [DllImport("gxfem", CallingConvention = CallingConvention.Cdecl)]
        public static extern uint gxb_complex_facet_count(IntPtr complex);

        [DllImport("gxfem", CallingConvention = CallingConvention.Cdecl)]
        public static extern void gxb_complex_forget(IntPtr complex, IntPtr renumbering);

        [DllImport("gxfem", CallingConvention = CallingConvention.Cdecl)]
        public static extern gx_result gxb_complex_insert(IntPtr complex, IntPtr triangle, uint element, IntPtr allowed, IntPtr user);

        [DllImport("gxfem", CallingConvention = CallingConvention.Cdecl)]
        public static extern int gxb_complex_is_sparse(IntPtr complex);

        [DllImport("gxfem", CallingConvention = CallingConvention.Cdecl)]
        public static extern IntPtr gxb_complex_label(IntPtr complex, uint label);

        [DllImport("gxfem", CallingConvention = CallingConvention.Cdecl)]
        public static extern uint gxb_complex_label_count(IntPtr complex);

        [DllImport("gxfem", CallingConvention = CallingConvention.Cdecl)]
        public static extern IntPtr gxb_complex_leaf(IntPtr complex, uint leaf);

        [DllImport("gxfem", CallingConvention = CallingConvention.Cdecl)]
        public static extern uint gxb_complex_leaf_at(IntPtr complex, uint element, IntPtr x, IntPtr toward, IntPtr on);

        [DllImport("gxfem", CallingConvention = CallingConvention.Cdecl)]
        public static extern uint gxb_complex_leaf_count(IntPtr complex);

        [DllImport("gxfem", CallingConvention = CallingConvention.Cdecl)]
        public static extern IntPtr gxb_complex_list(IntPtr complex, uint first);

        [DllImport("gxfem", CallingConvention = CallingConvention.Cdecl)]
        public static extern gx_result gxb_complex_load(IntPtr complex, IntPtr stream, int trusted);

        [DllImport("gxfem", CallingConvention = CallingConvention.Cdecl)]
        public static extern uint gxb_complex_marked_count(IntPtr complex);

        [DllImport("gxfem", CallingConvention = CallingConvention.Cdecl)]
        public static extern uint gxb_complex_marked_facet(IntPtr complex, uint index);

        [DllImport("gxfem", CallingConvention = CallingConvention.Cdecl)]
        public static extern int gxb_complex_marked_wall(IntPtr complex, uint index);

        [DllImport("gxfem", CallingConvention = CallingConvention.Cdecl)]
        public static extern uint gxb_complex_mesh_edge(IntPtr complex, uint mesh_edge);

        [DllImport("gxfem", CallingConvention = CallingConvention.Cdecl)]
        public static extern uint gxb_complex_mesh_edge_count(IntPtr complex);

        [DllImport("gxfem", CallingConvention = CallingConvention.Cdecl)]
        public static extern uint gxb_complex_node_count(IntPtr complex);

        [DllImport("gxfem", CallingConvention = CallingConvention.Cdecl)]
        public static extern gx_result gxb_complex_open_element(IntPtr complex, uint element);

        [DllImport("gxfem", CallingConvention = CallingConvention.Cdecl)]
        public static extern IntPtr gxb_complex_origin(IntPtr complex);

        [DllImport("gxfem", CallingConvention = CallingConvention.Cdecl)]
        public static extern gx_result gxb_complex_part(IntPtr complex, uint element, IntPtr vertices, IntPtr triangles, IntPtr list, uint count, uint few, IntPtr allowed, IntPtr user);

        [DllImport("gxfem", CallingConvention = CallingConvention.Cdecl)]
        public static extern IntPtr gxb_complex_plane(IntPtr complex, uint plane);

        [DllImport("gxfem", CallingConvention = CallingConvention.Cdecl)]
        public static extern IntPtr gxb_complex_point(IntPtr complex, uint point);

        [DllImport("gxfem", CallingConvention = CallingConvention.Cdecl)]
        public static extern uint gxb_complex_point_count(IntPtr complex);

        [DllImport("gxfem", CallingConvention = CallingConvention.Cdecl)]
        public static extern void gxb_complex_prefetch_element(IntPtr complex, uint element);

        [DllImport("gxfem", CallingConvention = CallingConvention.Cdecl)]
        public static extern void gxb_complex_prepare_points(IntPtr complex, uint first, uint end);

        [DllImport("gxfem", CallingConvention = CallingConvention.Cdecl)]
        public static extern int gxb_complex_pullback_side(IntPtr complex, IntPtr back, uint element, uint plane);

        [DllImport("gxfem", CallingConvention = CallingConvention.Cdecl)]
        public static extern void gxb_complex_reserve(IntPtr complex, uint times);

        [DllImport("gxfem", CallingConvention = CallingConvention.Cdecl)]
        public static extern void gxb_complex_rollback(IntPtr complex);

        [DllImport("gxfem", CallingConvention = CallingConvention.Cdecl)]
        public static extern uint gxb_complex_root(IntPtr complex, uint element);

        [DllImport("gxfem", CallingConvention = CallingConvention.Cdecl)]
        public static extern void gxb_complex_save(IntPtr complex, IntPtr stream);

        [DllImport("gxfem", CallingConvention = CallingConvention.Cdecl)]
        public static extern gx_result gxb_complex_set_removed(IntPtr complex, uint leaf);

        [DllImport("gxfem", CallingConvention = CallingConvention.Cdecl)]
        public static extern gx_result gxb_complex_set_wall(IntPtr complex, uint facet);

        [DllImport("gxfem", CallingConvention = CallingConvention.Cdecl)]
        public static extern int gxb_complex_shift(IntPtr complex);

        [DllImport("gxfem", CallingConvention = CallingConvention.Cdecl)]
        public static extern int gxb_complex_side(IntPtr complex, uint point, uint plane);

        [DllImport("gxfem", CallingConvention = CallingConvention.Cdecl)]
        public static extern uint gxb_complex_support(IntPtr complex, uint point, uint element);

        [DllImport("gxfem", CallingConvention = CallingConvention.Cdecl)]
        public static extern gx_result gxb_complex_survey(IntPtr complex, IntPtr pinned, IntPtr kinds, IntPtr renumbering);

        [DllImport("gxfem", CallingConvention = CallingConvention.Cdecl)]
        public static extern IntPtr gxb_complex_tree_node(IntPtr complex, uint node);

        [DllImport("gxfem", CallingConvention = CallingConvention.Cdecl)]
        public static extern int gxb_complex_turn(IntPtr complex, uint a, uint b, uint c, uint plane);

        [DllImport("gxfem", CallingConvention = CallingConvention.Cdecl)]
        public static extern int gxb_complex_winding(IntPtr complex, IntPtr points, UIntPtr point_count, IntPtr vertices, IntPtr triangles, UIntPtr triangle_count);

        [DllImport("gxfem", CallingConvention = CallingConvention.Cdecl)]
        public static extern gx_result gxb_facet_resolve_edges(IntPtr complex, uint facet, IntPtr first, IntPtr count);

        [DllImport("gxfem", CallingConvention = CallingConvention.Cdecl)]
        public static extern double gxb_fixed_determinant(IntPtr o, IntPtr a, IntPtr b, IntPtr c);

        [DllImport("gxfem", CallingConvention = CallingConvention.Cdecl)]
        public static extern int gxb_incircle(IntPtr a, IntPtr b, IntPtr c, IntPtr d);

        [DllImport("gxfem", CallingConvention = CallingConvention.Cdecl)]
        public static extern int gxb_insphere(IntPtr a, IntPtr b, IntPtr c, IntPtr d, IntPtr e);

        [DllImport("gxfem", CallingConvention = CallingConvention.Cdecl)]
        public static extern int gxb_is_allocator(IntPtr allocator);

        [DllImport("gxfem", CallingConvention = CallingConvention.Cdecl)]
        public static extern gx_result gxb_leaf_resolve_facets(IntPtr complex, uint leaf, IntPtr first, IntPtr count);

        [DllImport("gxfem", CallingConvention = CallingConvention.Cdecl)]
        public static extern void gxb_num_add(IntPtr r, IntPtr a, IntPtr b);

        [DllImport("gxfem", CallingConvention = CallingConvention.Cdecl)]
        public static extern void gxb_num_mul(IntPtr r, IntPtr a, IntPtr b);

        [DllImport("gxfem", CallingConvention = CallingConvention.Cdecl)]
        public static extern double gxb_num_ratio(IntPtr a, IntPtr b);

        [DllImport("gxfem", CallingConvention = CallingConvention.Cdecl)]
        public static extern void gxb_num_set(IntPtr r, double value, int shift);

        [DllImport("gxfem", CallingConvention = CallingConvention.Cdecl)]
        public static extern void gxb_num_sub(IntPtr r, IntPtr a, IntPtr b);

        [DllImport("gxfem", CallingConvention = CallingConvention.Cdecl)]
        public static extern double gxb_num_to_double(IntPtr a);

        [DllImport("gxfem", CallingConvention = CallingConvention.Cdecl)]
        public static extern int gxb_orient2d(IntPtr a, IntPtr b, IntPtr c);

        [DllImport("gxfem", CallingConvention = CallingConvention.Cdecl)]
        public static extern int gxb_orient3d(IntPtr a, IntPtr b, IntPtr c, IntPtr d);

        [DllImport("gxfem", CallingConvention = CallingConvention.Cdecl)]
        public static extern int gxb_orient_in_plane(IntPtr a, IntPtr b, IntPtr c, IntPtr plane);

        [DllImport("gxfem", CallingConvention = CallingConvention.Cdecl)]
        public static extern void gxb_plane_init(IntPtr plane, IntPtr p, IntPtr q, IntPtr r);

        [DllImport("gxfem", CallingConvention = CallingConvention.Cdecl)]
        public static extern void gxb_point_explicit(IntPtr point, IntPtr p);

        [DllImport("gxfem", CallingConvention = CallingConvention.Cdecl)]
        public static extern void gxb_point_line_plane(IntPtr point, IntPtr p, IntPtr q, IntPtr plane);

        [DllImport("gxfem", CallingConvention = CallingConvention.Cdecl)]
        public static extern void gxb_point_three_planes(IntPtr point, IntPtr a, IntPtr b, IntPtr c);

        [DllImport("gxfem", CallingConvention = CallingConvention.Cdecl)]
        public static extern int gxb_pullback_contains(IntPtr back);

        [DllImport("gxfem", CallingConvention = CallingConvention.Cdecl)]
        public static extern int gxb_pullback_misses(IntPtr corners, IntPtr point);

        [DllImport("gxfem", CallingConvention = CallingConvention.Cdecl)]
        public static extern int gxb_pullback_orient(IntPtr back);

        [DllImport("gxfem", CallingConvention = CallingConvention.Cdecl)]
        public static extern void gxb_pullback_set(IntPtr back, IntPtr corners, IntPtr point);

        [DllImport("gxfem", CallingConvention = CallingConvention.Cdecl)]
        public static extern void gxb_pullback_weights(IntPtr back, IntPtr lambda);

        [DllImport("gxfem", CallingConvention = CallingConvention.Cdecl)]
        public static extern int gxb_side(IntPtr point, IntPtr plane);

        [DllImport("gxfem", CallingConvention = CallingConvention.Cdecl)]
        public static extern int gxb_stream_has(IntPtr stream, UIntPtr count, UIntPtr width);

        [DllImport("gxfem", CallingConvention = CallingConvention.Cdecl)]
        public static extern void gxb_stream_pass(IntPtr stream, IntPtr data, UIntPtr count, UIntPtr width);

        [DllImport("gxfem", CallingConvention = CallingConvention.Cdecl)]
        public static extern int gxb_winding_number(IntPtr vertices, IntPtr triangles, UIntPtr triangle_count, IntPtr p, IntPtr on_surface);

        [DllImport("gxfem", CallingConvention = CallingConvention.Cdecl)]
        public static extern void gxi_face_load_add(IntPtr a, IntPtr b, IntPtr c, double area, IntPtr load);

        [DllImport("gxfem", CallingConvention = CallingConvention.Cdecl)]
        public static extern void gxi_face_mass_add(IntPtr a, IntPtr b, IntPtr c, double area, IntPtr mass);

        [DllImport("gxfem", CallingConvention = CallingConvention.Cdecl)]
        public static extern void gxi_moments2_add(IntPtr m, IntPtr other);

        [DllImport("gxfem", CallingConvention = CallingConvention.Cdecl)]
        public static extern void gxi_moments2_add_triangle(IntPtr m, IntPtr a, IntPtr b, IntPtr c);

        [DllImport("gxfem", CallingConvention = CallingConvention.Cdecl)]
        public static extern void gxi_moments2_inertia(IntPtr m, double density, IntPtr centre, IntPtr inertia);

        [DllImport("gxfem", CallingConvention = CallingConvention.Cdecl)]
        public static extern void gxi_moments2_map(IntPtr m, IntPtr matrix, IntPtr translation);

        [DllImport("gxfem", CallingConvention = CallingConvention.Cdecl)]
        public static extern int gxi_moments2_repair(IntPtr m, IntPtr lower, IntPtr upper);

        [DllImport("gxfem", CallingConvention = CallingConvention.Cdecl)]
        public static extern void gxi_moments2_translate(IntPtr m, IntPtr shift);

        [DllImport("gxfem", CallingConvention = CallingConvention.Cdecl)]
        public static extern UIntPtr gxi_monomial_count(uint degree);

        [DllImport("gxfem", CallingConvention = CallingConvention.Cdecl)]
        public static extern UIntPtr gxi_monomial_index(uint i, uint j, uint k);

        [DllImport("gxfem", CallingConvention = CallingConvention.Cdecl)]
        public static extern gx_result gxi_monomials_translate(uint degree, IntPtr shift, IntPtr moments, IntPtr failure);

        [DllImport("gxfem", CallingConvention = CallingConvention.Cdecl)]
        public static extern void gxi_part_axes(uint k, IntPtr axes);

        [DllImport("gxfem", CallingConvention = CallingConvention.Cdecl)]
        public static extern void gxi_part_load(IntPtr reference, uint k, double element_volume, double density, IntPtr load);

        [DllImport("gxfem", CallingConvention = CallingConvention.Cdecl)]
        public static extern void gxi_part_mass(IntPtr reference, uint k, double element_volume, double density, IntPtr mass);

        [DllImport("gxfem", CallingConvention = CallingConvention.Cdecl)]
        public static extern gx_result gxi_part_moments(IntPtr lambdas, UIntPtr lambda_count, IntPtr triangles, UIntPtr triangle_count, IntPtr k, IntPtr reference);

        [DllImport("gxfem", CallingConvention = CallingConvention.Cdecl)]
        public static extern gx_result gxi_part_moments_at(IntPtr lambdas, UIntPtr lambda_count, IntPtr triangles, UIntPtr triangle_count, uint k, IntPtr reference);

        [DllImport("gxfem", CallingConvention = CallingConvention.Cdecl)]
        public static extern gx_result gxi_polyhedron_moments2(IntPtr surface, IntPtr origin, IntPtr m, IntPtr failure);

        [DllImport("gxfem", CallingConvention = CallingConvention.Cdecl)]
        public static extern gx_result gxi_polyhedron_monomial(IntPtr surface, IntPtr origin, uint i, uint j, uint k, IntPtr moment, IntPtr failure);

        [DllImport("gxfem", CallingConvention = CallingConvention.Cdecl)]
        public static extern gx_result gxi_polyhedron_monomials(IntPtr surface, IntPtr origin, uint degree, IntPtr moments, IntPtr work, IntPtr failure);

        [DllImport("gxfem", CallingConvention = CallingConvention.Cdecl)]
        public static extern gx_result gxi_surface_flux_monomials(IntPtr surface, IntPtr origin, uint degree, IntPtr moments, IntPtr work, IntPtr failure);

        [DllImport("gxfem", CallingConvention = CallingConvention.Cdecl)]
        public static extern gx_result gxi_surface_monomials(IntPtr surface, IntPtr origin, uint degree, IntPtr moments, IntPtr work, IntPtr failure);

        [DllImport("gxfem", CallingConvention = CallingConvention.Cdecl)]
        public static extern gx_result gxi_tet_gradients(IntPtr positions, IntPtr gradients, IntPtr volume);

        [DllImport("gxfem", CallingConvention = CallingConvention.Cdecl)]
        public static extern void gxi_tet_mass(double volume, double density, IntPtr mass);

        [DllImport("gxfem", CallingConvention = CallingConvention.Cdecl)]
        public static extern double gxi_tet_volume(IntPtr positions);

        [DllImport("gxfem", CallingConvention = CallingConvention.Cdecl)]
        public static extern double gxi_triangle_area(IntPtr a, IntPtr b, IntPtr c, IntPtr area_vector);

        [DllImport("gxfem", CallingConvention = CallingConvention.Cdecl)]
        public static extern double gxs_material_energy(IntPtr material, IntPtr deformation);

        [DllImport("gxfem", CallingConvention = CallingConvention.Cdecl)]
        public static extern void gxs_material_product(IntPtr material, IntPtr deformation, IntPtr direction, IntPtr product);

        [DllImport("gxfem", CallingConvention = CallingConvention.Cdecl)]
        public static extern void gxs_material_stress(IntPtr material, IntPtr deformation, IntPtr stress);

        [DllImport("gxfem", CallingConvention = CallingConvention.Cdecl)]
        public static extern gx_result gxs_solver_create(IntPtr desc, IntPtr solver, IntPtr failure);

        [DllImport("gxfem", CallingConvention = CallingConvention.Cdecl)]
        public static extern void gxs_solver_destroy(IntPtr solver);

        [DllImport("gxfem", CallingConvention = CallingConvention.Cdecl)]
        public static extern gx_result gxs_solver_linearise(IntPtr solver, IntPtr displacement, double rate, uint exact, IntPtr failure);

        [DllImport("gxfem", CallingConvention = CallingConvention.Cdecl)]
        public static extern void gxs_solver_note_written(IntPtr solver, IntPtr origins, UIntPtr count, IntPtr displacement, IntPtr velocity, IntPtr rest_times);

        [DllImport("gxfem", CallingConvention = CallingConvention.Cdecl)]
        public static extern gx_result gxs_solver_product(IntPtr solver, IntPtr direction, IntPtr product, IntPtr failure);

        [DllImport("gxfem", CallingConvention = CallingConvention.Cdecl)]
        public static extern void gxs_solver_resume(IntPtr solver, IntPtr scene);

        [DllImport("gxfem", CallingConvention = CallingConvention.Cdecl)]
        public static extern void gxs_solver_scene(IntPtr solver, IntPtr scene);

        [DllImport("gxfem", CallingConvention = CallingConvention.Cdecl)]
        public static extern gx_result gxs_solver_set_model(IntPtr solver, IntPtr model, IntPtr failure);

        [DllImport("gxfem", CallingConvention = CallingConvention.Cdecl)]
        public static extern gx_result gxs_solver_step(IntPtr solver, IntPtr step, IntPtr displacement, IntPtr velocity, IntPtr report, IntPtr failure);

        [DllImport("gxfem", CallingConvention = CallingConvention.Cdecl)]
        public static extern gx_result gxs_solver_update(IntPtr solver, IntPtr change, IntPtr failure);

        [DllImport("gxfem", CallingConvention = CallingConvention.Cdecl)]
        public static extern gx_result gxs_step_check(IntPtr step, UIntPtr copy_count, ulong epoch, IntPtr failure);
    }
}
