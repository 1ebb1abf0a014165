/* SPDX-License-Identifier: MIT */
/* gxfem_solve.h - time steps of hyperelastic tetrahedra, implicit or explicit, matrix-free. Part of gxfem 0.2.0.
 *
 * In one source file:          #define GXFEM_SOLVE_IMPLEMENTATION       (link with -lm)
 * there and everywhere else:   #include "gxfem_solve.h"
 *
 * ONE MINUTE. A tetrahedron of edges of 1 m falls for one step of 1/30 s; compiles as it stands:
 *
 *     #define GXFEM_SOLVE_IMPLEMENTATION
 *     #include "gxfem_solve.h"
 *     int main(void)
 *     {
 *         gxs_element element = {{0, 1, 2, 3},                                      // its four copies
 *             {{-1, -1, -1}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}},                      // gradients, 1/m
 *             1.0 / 6, {17, 8, 8, 8, 17, 8, 8, 17, 8, 17}, 0, 0};                   // m3; kg
 *         gxs_material material = {GXS_STABLE_NEO_HOOKEAN, 1e6, 0.4, 0, NULL, NULL};
 *         double displacement[12] = {0}, velocity[12] = {0};
 *         gxs_model model = {4, NULL, &element, 1, &material, 1, NULL, 0, NULL, 0, 0, NULL, 0};
 *         gxs_step_desc step = {0};
 *         gxs_solver *solver = NULL;
 *         gx_result result = gxs_solver_create(NULL, &solver, NULL);
 *         step.dt = 1.0 / 30;
 *         step.gravity[2] = -9.81;
 *         if (result == GX_OK)
 *             result = gxs_solver_set_model(solver, &model, NULL);
 *         if (result == GX_OK)
 *             result = gxs_solver_step(solver, &step, displacement, velocity, NULL, NULL);
 *         gxs_solver_destroy(solver);
 *         return (int)result;
 *     }
 *
 * CONTENTS. Search for the anchors, which are in the order of the file. Functions call functions of their own section
 * and of earlier ones only.
 *   interface:    >>shared result codes, allocator, jobs | >>types materials, elements, step | >>functions the API
 *   foundations:  >>constants sizes, limits | >>scalars bits, sums | >>memory pools | >>structs the solver's own
 *                 form | >>columns arrays over copies, slots, chunks | >>jobs loops
 *   kernels:      >>svd stretches and rotations of F | >>material energies, stresses | >>tangent Hessian of one block |
 *                 >>element passes over one block
 *   chunks:       >>masses of parts of elements | >>order of elements | >>lanes of a chunk | >>chunks blocks, slots |
 *                 >>affine elements with affine copies | >>copies fixed, following, connected |
 *                 >>followers constraints between copies
 *   structure:    >>transfer between levels | >>levels their patterns | >>nested level 1 of affine copies |
 *                 >>pattern of level 1 | >>hierarchy all levels | >>lights copies with next to no mass |
 *                 >>sharing of memory | >>system a model in the solver's form
 *   operator:     >>rule elements with affine copies | >>forces energies, forces | >>blocks 3x3 blocks |
 *                 >>strains forces, exact Hessians in single precision | >>singles affine copies' products |
 *                 >>product single precision | >>doubles double precision | >>linearise Hessians, block diagonal
 *   multigrid:    >>galerkin coarse matrices | >>nesting those of affine copies | >>factor of the last level |
 *                 >>assembly the assembled matrix | >>smoother its step length | >>cycle the V-cycle
 *   changes:      >>edits lanes that a cut changes | >>affine-edits those of affine copies |
 *                 >>renewal copies and components | >>update levels, all of it
 *   steps:        >>components momentum | >>points springs, contact | >>pairs two sides in contact | >>terms all that
 *                 acts at points | >>cg conjugate gradients | >>ageing of coarse matrices | >>sleep rest |
 *                 >>balance residual, start | >>search lengths | >>integrators BDF, midpoint | >>newton iterations,
 *                 bound on E | >>midpoint second half, end of a step | >>leapfrog explicit steps | >>quick steps of a
 *                 few iterations
 *   entrance:     >>check what is given | >>quality steps by the error asked for | >>api the public functions |
 *                 >>single a material at one F
 *
 * WORDS. Copy: a node's displacement for one connected set of cells. Component: copies joined by elements and
 * constraints. Lane, block, chunk: an element's place, eight lanes, 48 blocks. Slot: a copy's place in the results of
 * one chunk. Loose component: no copy of it is held or touched by springs or contact. Light copy: next to none of the
 * mass around it is its own. Base: where a step would end that only moves held copies to their targets.
 *
 * WHAT IT DOES. A step of length h is the minimum over the displacements u of the incremental potential
 *
 *     E(u) = |u - u_n - h v_n|_M^2 / (2 h^2) + U(u) + C(u) - f . u        GXFEM Eq. 10 divided by h^2; joule
 *
 * M: mass, U: elastic energy, C: springs and contact, f = M g + nodal forces. f is a linear term, so M is never
 * inverted. Then v = (u - u_n) / h. This is backward Euler. BDF2 and the implicit midpoint rule have other values in
 * place of h and u_n + h v_n; statics have no mass. Mass damping (Rayleigh) is in the first term, stiffness damping in
 * U. Explicit steps minimise nothing: see GXS_EXPLICIT.
 *
 * Newton's method with a line search minimises E. The Hessian of every element is projected to the nearest positive
 * semi-definite one in closed form (analytic eigensystem). Near the end, where steps are whole, the exact one is tried.
 * Products are matrix-free: eight elements side by side in a block, 48 blocks in a chunk. Each chunk has sums of its
 * own, which are added in the order of chunks. So results are the same for any number of threads.
 *
 * Conjugate gradients with multigrid solve the linear systems. The finest level is the model itself, smoothed by
 * block-Jacobi. Coarse levels live on lattices whose points are doubled where a cut separates the copies around them;
 * the first level for which that is cheap is factorised. Coarse matrices serve until iterations rise. The last two
 * steps' directions are the guess for the next.
 *
 * E is a sum over components. The line search finds a step length for each, so that none is flung about for the gain of
 * another. Every loose component first moves as a whole so that its momentum balances. Later iterations leave its
 * momentum alone: it is right to rounding whatever the tolerances are, and free fall takes no iteration. Newton's
 * method starts at u_n + h v_n. Each component's E at the end is compared with its E at u_n, to which a loose component
 * is first translated by its momentum. One that ended higher goes back towards u_n as far as E falls. So
 * E(u) <= E(u_n) in each component, however fast it falls: a step cannot blow up. The midpoint rule continues from
 * there as far again, or less far where it would gain energy.
 *
 * Residuals have two measures, both scaled by the block diagonal D of the Hessian: energy, sqrt(sum r_i . D_i^-1 r_i),
 * and displacement, sqrt(sum |D_i^-1 r_i|^2). The second one sees a component of 1e-12 of its neighbour's volume as
 * well as the neighbour. A component that has been slower than gxs_step_desc.sleep_speed for long sleeps; steps leave
 * it out until something touches it.
 *
 * WHAT IT DOES NOT DO. No cutting and no meshes: it sees elements of four copies. No search for contacts between
 * components: give points, planes, pairs and your own forces. No threads of its own: see gx_jobs; a task takes up to 32
 * kB of stack.
 *
 * LIMITS. poisson in [0, 0.5); beyond 0.49999 the Hessian's single precision shows. Copies and elements below 2^30.
 * Energies, forces and states are doubles. The Hessian, its products and the preconditioner are single precision, which
 * limits one linear solve (to about 1e-6 of the residual), not the state that Newton's method reaches. The slowest
 * modes of a free body are solved too, as long as inertia is above about 1e-6 of stiffness: rho h^2 / (E dt^2) for
 * elements of size h. The centre of the mass of a part of an element is rounded once, by at most 1e-7 of the element.
 * Memory: 240 to 270 bytes per element in all for a mesh with four elements per copy; 290 to 350 where cuts leave two
 * or three. The material can invert without a failure and recovers by itself. An element collapsed to a point, where
 * its energy is stationary, is opened as if it were not quite collapsed. The same input gives the same bits with the
 * same binary. Nothing here needs isnan or infinities, so results are right under -ffast-math, though sums round
 * differently.
 *
 * REFERENCES. GXFEM: Generalized eXtended Finite Element Method for Deformable Cutting via Boolean Operations, 2024.
 * RXFEM: Koschier, Bender, Thuerey, Robust eXtended Finite Elements for Complex Cutting of Deformables, ACM Trans.
 * Graph. 36(4), 2017. Smith 2018: Smith, de Goes, Kim, Stable Neo-Hookean Flesh Simulation, ACM Trans. Graph. 37(2),
 * 2018. BDF2 with steps that vary: Hairer, Norsett, Wanner, Solving Ordinary Differential Equations I, III.5. Stomakhin
 * 2012: Stomakhin, Howes, Schroeder, Teran, Energetically Consistent Invertible Elasticity, SCA 2012.
 *
 * MACROS. GXFEM_SOLVE_IMPLEMENTATION or GXFEM_IMPLEMENTATION: the code comes here. GXFEM_STATIC: all static.
 * GXFEM_INTRINSICS: intrinsics, from the compiler's own headers, in place of extensions: vectors of SSE2 or 64-bit
 * NEON, products of 64-bit integers. cl, which has no extensions, takes them unless GXFEM_NO_INTRINSICS is defined.
 */
#ifndef GXFEM_SOLVE_INCLUDED
#define GXFEM_SOLVE_INCLUDED

/* >>shared: this block is the same in every gxfem header; `make lint` compares the copies */
#ifndef GXFEM_SHARED_INCLUDED
#define GXFEM_SHARED_INCLUDED
#include <stddef.h>
#include <stdint.h>

/* cl has neither vectors nor integers of 128 bits of its own: it takes intrinsics, from the compiler's headers. */
#if defined(_MSC_VER) && !defined(__clang__) && !defined(GXFEM_NO_INTRINSICS) && !defined(GXFEM_INTRINSICS)
#define GXFEM_INTRINSICS
#endif

/* With -msimd128 clang before 16 moves a load that fills a vector behind stores to the same address: the headers'
   functions are compiled without vectors then (GXFEM_SCALAR), and not inlined where there are some. */
#if defined(__wasm_simd128__) && defined(__clang__) && __clang_major__ < 16
#define GXFEM_SCALAR
#define GXFEM_APART __attribute__((noinline))
#else
#define GXFEM_APART
#endif

/* The version of all headers. GXFEM_VERSION is one number that can be compared: 200 is 0.2.0. */
#define GXFEM_VERSION_MAJOR 0
#define GXFEM_VERSION_MINOR 2
#define GXFEM_VERSION_PATCH 0
#define GXFEM_VERSION       (GXFEM_VERSION_MAJOR * 10000 + GXFEM_VERSION_MINOR * 100 + GXFEM_VERSION_PATCH)

/* GXFEM_API stands before every public function. Define it before inclusion to build or use a shared library:
   __declspec(dllexport) in the file with the implementation and __declspec(dllimport) elsewhere, or
   __attribute__((visibility("default"))). On WebAssembly put GXFEM_APART in front of it.
   GXFEM_STATIC makes every function private to the file that includes the headers, unless GXFEM_API is defined. */
#ifndef GXFEM_API
#ifdef GXFEM_STATIC
#define GXFEM_API GXFEM_APART static inline
#else
#define GXFEM_API GXFEM_APART extern
#endif
#endif

/* What a function that can fail returns. On anything but GX_OK its inputs are as they were. */
typedef enum gx_result {
    GX_OK = 0,
    GX_ERROR_ARGUMENT,   /* a required pointer is NULL, a required field is zero or senseless */
    GX_ERROR_MEMORY,     /* the allocator returned NULL */
    GX_ERROR_NOT_FINITE, /* a coordinate or parameter is NaN or infinite */
    GX_ERROR_RANGE,      /* a coordinate, a mass or another number is too large or too small (see "limits") */
    GX_ERROR_INDEX,      /* an index points outside its array */
    GX_ERROR_EMPTY,      /* no elements, no nodes or no triangles; a region that holds no copy */
    GX_ERROR_INVERTED,   /* an element has negative volume */
    GX_ERROR_FLAT,       /* an element has no volume */
    GX_ERROR_OVERLAP,    /* an element face is shared by more than two elements, or by two on one side */
    GX_ERROR_NOT_CLOSED, /* a solid's surface has a boundary, or its triangles are not oriented alike */
    GX_ERROR_LIMIT,      /* more objects than 32-bit indices can name, or the caller's memory limit is reached */
    GX_ERROR_DIVERGED,   /* a time step found no finite state of lower energy */
    GX_ERROR_FREE,       /* a static balance is asked of a component, copies joined by elements, that nothing holds */
    GX_ERROR_FORMAT,     /* not a saved body, or one of another version or another kind of machine */
    GX_ERROR_DAMAGED,    /* a saved body is cut short, or what it says cannot be */
    GX_ERROR_STALE,      /* copies are named by a numbering that a cut has changed (see gxs_model.epoch) */
    GX_ERROR_CONFIGURATION, /* arithmetic is not what exact predicates need: see >>numbers in gxfem_boolean.h */
    GX_ERROR_SEQUENCE,      /* called too early, or too late: another call must come before */
    GX_ERROR_CAPACITY       /* the caller's array or memory is too small */
} gx_result;

/* What was refused, and where. A call that succeeds sets it too, to GX_OK. */
typedef struct gx_failure {
    gx_result result;
    /* The name of an argument, or of a member of the struct that an argument points to, with the members on the way:
       "positions", "dt", "surfaces.vertices", "springs.point.copy". GX_ERROR_SEQUENCE: the call that must come before,
       as "gx_body_skin". A string literal. NULL: nothing given is to blame */
    const char *field;
    size_t index;   /* of the node, element, triangle, copy ... concerned; SIZE_MAX: no single one is */
    size_t surface; /* of a cut: which of its surfaces; of a group: which of its bodies; else SIZE_MAX */
} gx_failure;

/* Where memory comes from. Zero-initialised: malloc, free and realloc. */
typedef struct gx_allocator {
    void *(*allocate)(void *user, size_t size);             /* NULL when there is none; size is never 0 */
    void (*release)(void *user, void *memory, size_t size); /* size as it was allocated; memory is never NULL */
    void *user;
    /* A larger block with the bytes of the old one, which is then gone; NULL when there is none, and the old one stays.
       NULL: memory that grows is allocated, copied and released. Only with the other two. */
    void *(*reallocate)(void *user, void *memory, size_t size, size_t larger);
} gx_allocator;
/* How work is handed to the host's threads. Zero-initialised: the calling thread does it all. Results do not depend on
 * it. */
typedef struct gx_jobs {
    /* Calls task(context, i) once for each i below count, on any threads, in any order, and returns when all have
     * returned. */
    void (*parallel_for)(void *user, size_t count, void (*task)(void *context, size_t index), void *context);
    void *user;
} gx_jobs;
#endif /* GXFEM_SHARED_INCLUDED */

#ifdef __cplusplus
extern "C" {
#endif

/* >>types */

/* Energies per volume of the deformation gradient F. In small strain all are linear elasticity with Young's modulus and
 * Poisson's ratio. */
typedef enum gxs_material_kind {
    GXS_STABLE_NEO_HOOKEAN = 0, /* for large strain, inversion and nearly incompressible bodies [Smith 2018] */
    GXS_ST_VENANT_KIRCHHOFF,    /* RXFEM's; under compression it softens until nothing resists */
    GXS_FIXED_COROTATED,        /* [Stomakhin 2012]; linear except for rotations and volume */
    GXS_LINEAR,                 /* for small rotations only */
    GXS_CUSTOM                  /* the caller's own, by energy below */
} gxs_material_kind;

/* Energy density, J/m3, at a deformation gradient F (3x3 by rows); finite wherever F is. stress: P = d energy / dF, Pa,
 * by rows; hessian: dP_i/dF_j at [9 i + j], symmetric, not necessarily semi-definite. Either may be NULL. Called on the
 * threads of gx_jobs. */
typedef double (*gxs_energy_fn)(void *user, const double *deformation, double *stress, double *hessian);

typedef struct gxs_material {
    gxs_material_kind kind;
    double young;         /* Pa, above 0; GXS_CUSTOM: about its stiffness, for scaling only */
    double poisson;       /* 0 <= poisson < 0.5; GXS_CUSTOM: checked, not used */
    double damping;       /* Rayleigh's beta, s, 0 or more: stress grows by beta times its rate of change */
    gxs_energy_fn energy; /* GXS_CUSTOM only */
    void *user;
} gxs_material;

/* A linear tetrahedron, or the part of one that a cut has left. */
typedef struct gxs_element {
    uint32_t copy[4]; /* the copy that moves each corner; below copy_count */
    /* of the four shape functions, 1/m; row 0, minus the sum of the others, is not read */
    double gradient[4][3];
    double weight; /* volume, m3; 0 or more */
    /* rho int N_i N_j, kg, symmetric, semi-definite (made so if it is not) 4x4 block: 00 01 02 03 11 12 13 22 23 33. A
     * row sum below 2^-25 of the element's mass counts as 0 */
    double mass[10];
    uint32_t material; /* below material_count */
    /* the caller's, below 2^30: elements of one group are replaced together. Read by gxs_solver_update only */
    uint32_t group;
} gxs_element;

/* A copy that follows others: in every step its displacement changes by the weighted sum of the changes of theirs. An
 * affine copy (gxs_model.affine) follows their field: by the sum of w_k (a_k + A_k (X - X_k)), and its A by that of
 * w_k A_k; the model then has positions. A held copy follows nothing. Masters follow nothing themselves. */
typedef struct gxs_constraint {
    uint32_t copy;
    uint32_t master[4]; /* below copy_count, also where the weight is 0 */
    double weight[4];   /* 1 in sum if the copy is to follow translations */
} gxs_constraint;

#define GXS_NOT_AFFINE UINT32_MAX /* see gxs_model.affine */

/* Borrowed for the time of a call. */
typedef struct gxs_model {
    size_t copy_count;
    /* copy_count x 3: the copies' nodes at rest, m; NULL: no multigrid, and more memory. With positions, gradients that
     * agree with them (to 1e-11) are not stored */
    const double *positions;
    const gxs_element *elements; /* element_count */
    size_t element_count;
    const gxs_material *materials; /* material_count, up to one per element */
    size_t material_count;
    const uint8_t *held;  /* copy_count flags: not 0: the copy keeps its displacement; NULL: none is held */
    uint32_t lumped_mass; /* not 0: row sums of the mass; 0: as given (consistent) */
    const gxs_constraint *constraints; /* constraint_count, each of another copy */
    size_t constraint_count;
    /* names this numbering of copies. Springs, contact points, forces and targets of a step name the numbering that
     * they use; another one is GX_ERROR_STALE. 0 everywhere is fine as long as copies keep their numbers */
    uint64_t epoch;
    /* copy_count; NULL: none. For an affine copy i the index of the first of three vectors, hidden ones, that follow
     * each other below copy_count: the columns of A_i times affine_length. GXS_NOT_AFFINE for every other entry. Where
     * an element has an affine copy, u = sum N_i (a_i + A_i (x - X_i)), with A = 0 for its other copies. So a sheet
     * thinner than its elements bends as it should. A hidden vector is no element's copy, is held if its copy is, and
     * is in no constraint. A target of a held one is its A. Not with lumped_mass, GXS_MATRIX_ASSEMBLED and
     * GXS_VOLUME_RATIO. */
    const uint32_t *affine;
    double affine_length; /* m, above 0 where copies are affine: about an element's size */
} gxs_model;

/* The change that a cut makes to a model. Borrowed for the time of a call. */
typedef struct gxs_change {
    size_t copy_count; /* from now on */
    /* copy_count: 2 x the copy's index so far; for a new copy 2 x the index of the copy whose position and motion it
     * takes over, + 1 */
    const uint32_t *origins;
    const uint8_t *held;    /* copy_count flags as the model's; NULL: none is held */
    const uint32_t *groups; /* group_count, ascending: all elements of these groups go */
    size_t group_count;
    /* element_count, by ascending group: the elements in their place, of the model's materials */
    const gxs_element *elements;
    size_t element_count;
    const gxs_constraint *constraints; /* constraint_count: all constraints from now on */
    size_t constraint_count;
    /* copy_count, as gxs_model.affine; NULL: none. Hidden vectors have origins like copies. One whose origin is no
     * hidden vector begins with zeros: its copy becomes affine, and the elements around that copy are to be replaced */
    const uint32_t *affine;
    uint64_t epoch; /* of the numbering from now on */
} gxs_change;

typedef enum gxs_preconditioner {
    /* multigrid where it pays: in large components, in steps in which stiffness outweighs inertia */
    GXS_AUTOMATIC = 0,
    GXS_BLOCK_JACOBI, /* least memory; iterations grow with size, with loose fragments and with thin layers */
    GXS_MULTIGRID,    /* coarse functions that never cross a cut */
    GXS_VOLUME_RATIO  /* RXFEM Eq. 26, for comparison: each copy by the volume of its support */
} gxs_preconditioner;

typedef enum gxs_matrix {
    GXS_MATRIX_FREE = 0, /* products from the elements; no fine matrix is ever assembled */
    /* 3x3 blocks by rows: cheaper products for more memory and an assembly in each Newton iteration */
    GXS_MATRIX_ASSEMBLED
} gxs_matrix;

typedef struct gxs_solver_desc {
    gx_allocator allocator; /* zero: malloc, free. Memory must be aligned as malloc aligns it */
    gx_jobs jobs;           /* zero: none */
    gxs_preconditioner preconditioner;
    gxs_matrix matrix;
} gxs_solver_desc;

/* How time is discretised. All but GXS_EXPLICIT are implicit and minimise a potential of the form of E above. */
typedef enum gxs_integrator {
    GXS_BDF1 = 0, /* backward Euler: first order, damps motion that it cannot resolve */
    GXS_BDF2,     /* second order, damps less; the first step is backward Euler */
    /* implicit midpoint: second order, damps nothing; needs steps that resolve the motion. Where Newton or CG end
       early, or springs or contact begin to act after the middle of a step, its second half is shortened, component by
       component: none gains more than 1 % of its kinetic energy */
    GXS_MIDPOINT,
    /* no inertia, velocities 0. dt 0: balance of forces; GX_ERROR_FREE if nothing holds a component. dt above 0: the
       mass over dt^2 holds every copy where it was, so that free components have an answer */
    GXS_STATIC,
    /* leapfrog in substeps, for soft bodies in motion: second order, damps nothing. Mass is lumped; light copies get
       0.3 % of the body's mass more. Forces are single precision. Stable neo-Hookean materials without damping, under
       gravity and forces, without targets, springs, contact points, pairs, constraints or affine copies. Any other
       step is backward Euler: see gxs_step_report.substeps. So is one that would take more than 64 substeps of its own
       choice, one whose elements are stretched too far for the substeps, and one in which energy would rise */
    GXS_EXPLICIT
} gxs_integrator;

#define GXS_POINT_OWN  4  /* copies for which a point has room itself */
#define GXS_POINT_MOST 64 /* copies of a point at most */

/* A material point: a node, a point of an element, a vertex of a skin. Its displacement is the sum of weight x that of
 * copy, over a span of count copies. Up to GXS_POINT_OWN stand in the point, which may then be kept and copied. More
 * stand in the caller's arrays, which last as long as the point is used. */
typedef struct gxs_point {
    uint32_t count;               /* above 0 */
    uint32_t copy[GXS_POINT_OWN]; /* count, if copies is NULL; below copy_count, also where the weight is 0 */
    double weight[GXS_POINT_OWN]; /* of the shape functions there, 1 in sum */
    const uint32_t *copies;       /* count; NULL: copy and weight */
    const double *weights;        /* count; NULL with copies */
    double position[3];           /* at rest, m */
    uint64_t epoch;               /* names the numbering of copies: the model's, else GX_ERROR_STALE */
} gxs_point;

/* Pulls a point to a target: a hand, a haptic tool, an elastic tether. Energy stiffness/2 |x - target|^2 */
typedef struct gxs_spring {
    gxs_point point;
    double target[3]; /* m, in space */
    double stiffness; /* N/m, 0 or more */
} gxs_spring;

/* Keeps contact points on the side of normal . x >= offset by a penalty of stiffness/2 depth^2 a point. Friction is
 * friction x the normal force at the step's start; below sticking_speed it is proportional to the speed. */
typedef struct gxs_plane {
    double normal[3];      /* of length 1 */
    double offset;         /* m */
    double stiffness;      /* N/m, 0 or more; 0: it stops nothing */
    double friction;       /* Coulomb's coefficient, 0 or more */
    double sticking_speed; /* m/s; 0: 1e-3 */
} gxs_plane;

/* A contact point's energy, J, at a position; force: on the point, minus its gradient, N; hessian: of the energy, N/m,
 * semi-definite, 00 01 02 11 12 22, or NULL. Called on the thread of the step only. */
typedef double (*gxs_contact_fn)(void *user, size_t point, const double *position, double *force, double *hessian);

/* Of a pair */
enum {
    GXS_PAIR_OUTSIDE = 1, /* the other side is outside the model */
    GXS_PAIR_WAKES = 2    /* components that it joins are awake in this step: the other side has moved */
};
/* Keeps two material points, or a point and a triangle, from going through each other: a point of relative position
 * r. Its weights are 0 in sum: those of one side, and minus those of the other. Its position is that of one side at
 * rest minus that of the other, m. Energy stiffness/2 depth^2 where depth = offset - normal . r is above 0. Both sides
 * get the same force, in opposite directions, so that pairs leave momentum alone. Where normal is along r they leave
 * angular momentum alone, too. Friction is Coulomb's: friction x the normal force at the step's start. It comes from
 * an elastic slip, which gxs_step_desc.pair_slips keeps: up to friction x force / stiffness, and at least
 * sticking_speed x dt, the sides stick. Not for GXS_MIDPOINT, which would gain energy. Hidden vectors of affine copies
 * have no part in these sums. The other side may be outside the model, as a rigid body is: then weights are 1 in sum,
 * position is that of the point at rest minus the place of the other side at the step's end, and way is how far that
 * place has gone within the step. */
typedef struct gxs_pair {
    gxs_point point;
    uint32_t flags;        /* GXS_PAIR_, or 0 */
    double way[3];         /* m; GXS_PAIR_OUTSIDE only */
    double normal[3];      /* of length 1, from the other side to this one */
    double offset;         /* m */
    double stiffness;      /* N/m, 0 or more */
    double friction;       /* Coulomb's coefficient, 0 or more */
    double sticking_speed; /* m/s; 0: 1e-3 */
} gxs_pair;

typedef struct gxs_step_desc {
    double dt;            /* s, above 0; GXS_STATIC: 0 or more */
    double gravity[3];    /* m/s2 */
    const double *forces; /* copy_count x 3, N; NULL: none */
    gxs_integrator integrator;
    /* copy_count x 3, of the step before; BDF2 only; NULL: none */
    const double *previous_displacement, *previous_velocity;
    double previous_dt; /* s, of the step before; BDF2 only */
    /* copy_count x 3: displacement of held copies at the step's end; others are not read. NULL: held copies stay */
    const double *targets;
    /* names the numbering of forces and targets: the model's, else GX_ERROR_STALE. Read if one of them is given */
    uint64_t epoch;
    double mass_damping; /* Rayleigh's alpha, 1/s, 0 or more: force -alpha M v */
    uint32_t substeps;   /* GXS_EXPLICIT only: that many of dt; 0: as few as are cheap, for errors of about 1 % */
    /* at most. 0: 1; where copies are affine, in steps in time, as many as thin sheets need that are flung: until one
     * moves affine copies by less than a hundredth of their motion in the step, 40 at most */
    uint32_t newton_iterations;
    /* above 0: a quick step of BDF1, BDF2 or the midpoint rule, for about a third of the time of a usual one: so many
     * iterations of conjugate gradients at most (2 or 3 are enough in soft bodies) from where inertia leads, with the
     * Hessian there and the preconditioner of earlier steps. No line search, no measure of balance:
     * newton_iterations, newton_tolerance and cg_iterations are not read. A component whose energy would rise is slowed
     * down. Mass is lumped, forces are single precision. Stable neo-Hookean materials without damping, under gravity
     * and forces, without targets, springs, contact points, pairs, constraints or affine copies; not with
     * GXS_MATRIX_ASSEMBLED or GXS_VOLUME_RATIO. Any other step is a usual one, as is one that would gain too much
     * energy: see gxs_step_report.quick */
    uint32_t quick;
    /* stop at this residual (see gxs_step_report); 0: 1e-8, far below what one iteration leaves in motion */
    double newton_tolerance;
    uint32_t cg_iterations; /* per Newton iteration, at most; 0: 1000 */
    /* reduction of the residual by each linear solve, below 1; 0: 1e-2, and 1e-3 with the midpoint rule, which does not
     * damp the error. Where copies are affine, reduction of the error, as the root of its energy: thin sheets bend long
     * before the residual of their stretch is gone. */
    double cg_tolerance;
    const gxs_spring *springs; /* spring_count */
    size_t spring_count;
    /* spring_count x 3: receives the force of each spring on the body at the end, N; or NULL */
    double *spring_forces;
    const gxs_point *points; /* point_count: of contact */
    size_t point_count;
    const gxs_plane *planes; /* plane_count, for every contact point */
    size_t plane_count;
    gxs_contact_fn contact; /* for every contact point; NULL: none */
    void *contact_user;
    /* pair_count. Pieces that a pair joins share step lengths, and sleep together or not at all. Other pairs than
     * before wake nothing, but a piece that has lost all its pairs wakes */
    const gxs_pair *pairs;
    size_t pair_count;
    /* pair_count x 3: elastic slip of each pair at the step's start, m; receives that at the end, 0 without force.
     * NULL: 0, and friction then creeps */
    double *pair_slips;
    /* pair_count x 3: receives the force of each pair at the end, N, on the side of positive weights; or NULL */
    double *pair_forces;
    /* m/s: a component (copies joined by elements) sleeps when none of its copies has been faster for sleep_time. Steps
     * leave it out until something touches it: what is given here changes for it, or its state is written. Changes
     * inside contact() are not seen: set rest_times to 0 where it moves. 0: none sleeps */
    double sleep_speed;
    double sleep_time; /* s; 0: 0.5 */
    /* copy_count: for how long each copy has been slower, s; read and written. Required with sleep_speed */
    double *rest_times;
    double (*clock)(void *user); /* s; NULL: the report's seconds are 0, and budget_seconds must be 0 */
    void *clock_user;
    /* no iteration begins after this time, and the step ends with what it has; 0: no limit. Results then depend on the
     * machine */
    double budget_seconds;
    /* above 0: the error asked for, in place of integrator, substeps, quick, Newton's and CG's numbers and
     * previous_..., which are not read; 0: those hold. The step is then divided into as many as the motion demands,
     * explicit or implicit. The error is that of the displacement after a third of a second of such motion, as a share
     * of the motion (root of the mean square by mass), beside exact time steps of the same elements: about, see
     * gxs_step_report.error. What more than GXS_PARTS steps would have to follow is damped. Held copies go to their
     * targets on straight lines. With budget_seconds the error is larger where this one takes longer. */
    double quality;
} gxs_step_desc;

/* Steps at most into which gxs_step_desc.quality divides one */
#define GXS_PARTS 32

/* Why a step ended */
typedef enum gxs_stop {
    GXS_STOP_BALANCE = 0, /* the residual is below newton_tolerance */
    GXS_STOP_ITERATIONS,  /* newton_iterations are done */
    GXS_STOP_SECONDS,     /* budget_seconds are over */
    GXS_STOP_ROUNDING,    /* doubles cannot tell a lower energy */
    GXS_STOP_ASLEEP       /* nothing to move: every component sleeps or is held */
} gxs_stop;

typedef struct gxs_step_report {
    gxs_stop stop;
    /* displacements solved for: three per copy that is awake, not held and follows nothing */
    size_t active_unknowns;
    uint32_t substeps; /* of GXS_EXPLICIT; 0: the step was implicit */
    uint32_t quick;    /* not 0: the step was quick (with quality: the last of them). Then there is no residual */
    uint32_t parts;    /* steps taken: 1 without quality; their iterations and seconds are summed */
    gxs_integrator integrator; /* of the last of them */
    double error;              /* with quality: the estimate of what was asked for; 0: nothing is known of the motion */
    uint32_t newton_iterations; /* 0: the start was in balance to rounding, or the step was explicit or quick */
    uint32_t cg_iterations;     /* sum over Newton iterations */
    uint32_t line_search_steps; /* step lengths tried; sum over Newton iterations */
    /* |load - inertia - elastic| / (|load| + |inertia| + |elastic|) on copies that are not held; the larger of the two
     * measures (see above) */
    double residual;
    /* E at the end, J, without sleeping components and up to a constant, the load on held copies. With the midpoint
     * rule this and the residual are those at half the step. Quick steps: the sum of elastic, kinetic and potential
     * energy */
    double energy;
    gxs_preconditioner preconditioner; /* in the last linear solve; GXS_AUTOMATIC: there was none */
    double seconds;           /* of the step; gx_body_step includes the renewal of the solver's model after a cut */
    double seconds_linearise; /* in Hessians and their diagonal */
    double seconds_prepare;   /* in assembly and the numbers of the preconditioner */
    double seconds_solve;     /* in conjugate gradients */
} gxs_step_report;

/* What acts on all components in a step. A change of it wakes sleeping ones. */
typedef struct gxs_scene {
    double gravity[3];                /* m/s2 */
    uint64_t planes, forces, springs; /* hashes */
} gxs_scene;

/* A model in the solver's own form, and the workspace of its steps; one call at a time. */
typedef struct gxs_solver gxs_solver;

/* >>functions
 * Functions that return a gx_result check all that they read: GX_ERROR_ARGUMENT, _EMPTY, _LIMIT, _RANGE, _INDEX,
 * _NOT_FINITE (index: of the element, material, constraint, copy, spring, point, plane or pair), _INVERTED (weight
 * below 0; index: element), _SEQUENCE. Steps also GX_ERROR_STALE (copies of another epoch than the model's; index:
 * spring, point or pair). Outputs are written on GX_OK only. failure and report may be NULL. */

/* Advances displacement (m) and velocity (m/s), both copy_count x 3 of the model set last and not overlapping, by one
 * step. Held copies keep their displacement or go to their target. Copies that no element gives weight or mass stay
 * where they are. Both get the velocity of that motion. GX_ERROR_SEQUENCE: no model is set. GX_ERROR_DIVERGED and, with
 * GXS_STATIC, GX_ERROR_FREE leave displacement and velocity unchanged. A residual above newton_tolerance when the
 * iterations are used up is no error: see the report. Allocates (GX_ERROR_MEMORY) only in the first step by multigrid
 * after a change of the model, in the first one of a model with GXS_EXPLICIT or quick, and if there are more springs,
 * contact points and pairs, or copies of them, than ever before. */
GXFEM_API gx_result gxs_solver_step(gxs_solver *solver, const gxs_step_desc *step, double *displacement,
                                    double *velocity, gxs_step_report *report, gx_failure *failure);
/* Checks the parts of a step's description that need no solver: its numbers, springs, points, planes and pairs, and
   whether all that names copies does so by the numbering `epoch` of copy_count copies. Other arrays over copies are not
   read. Errors: ARGUMENT, NOT_FINITE, RANGE, INDEX, LIMIT, STALE. */
GXFEM_API gx_result gxs_step_check(const gxs_step_desc *step, size_t copy_count, uint64_t epoch,
                                   gx_failure *failure /* or NULL */);

/* Sets the model that the next steps move. Call it again after each cut and each change of materials or held copies.
 * The model is copied into the solver's own form. GX_ERROR_MEMORY is possible. On any error the old model stays. */
GXFEM_API gx_result gxs_solver_set_model(gxs_solver *solver, const gxs_model *model, gx_failure *failure);

/* Changes the model. The time is proportional to the size of the change, plus a little for each copy of the model.
 * Preconditioner and guesses are kept. Results are those of the whole model set anew, up to rounding and the tolerances
 * of steps. GX_ERROR_SEQUENCE: no model is set. GX_ERROR_ARGUMENT: groups or elements are not in order (index: of the
 * group or element), or a constraint is not allowed (its index). GX_ERROR_LIMIT: the change does not fit. Either the
 * matrix is assembled, mass is lumped, GXS_VOLUME_RATIO is used, empty lanes exceed a quarter of the elements by two
 * chunks, GXS_AUTOMATIC would now choose otherwise, a copy is held that was not or the other way round, two old copies
 * (origins without + 1) are the same, no element is left, an element that stays has lost a copy, the first affine copy
 * comes or the last one goes. After this and GX_ERROR_MEMORY no model is set: set one. On other errors the old model
 * stays. */
GXFEM_API gx_result gxs_solver_update(gxs_solver *solver, const gxs_change *change, gx_failure *failure);
/* Sets to 0 the rest times of copies whose state has been written since the last step. Their components then wake even
 * if another model is set before the next step, or another solver takes that step. Vectors use the present numbering;
 * origins (count): as in gxs_change. */
GXFEM_API void gxs_solver_note_written(const gxs_solver *solver, const uint32_t *origins, size_t count,
                                       const double *displacement, const double *velocity, double *rest_times);
/* For saving a state and continuing later. gxs_solver_scene gives the scene of the last step. gxs_solver_resume makes
 * the solver as if its model had just been set after a step in that scene; a model that has been updated is dropped and
 * must be set. Two solvers resumed with the same model, scene and states take the same steps, bit by bit. */
GXFEM_API void gxs_solver_scene(const gxs_solver *solver, gxs_scene *scene);
GXFEM_API void gxs_solver_resume(gxs_solver *solver, const gxs_scene *scene);

/* The model's operator for other uses than steps: a Krylov method of one's own, modes, an adjoint. gxs_solver_linearise
 * makes it at a displacement. gxs_solver_product applies it any number of times, matrix-free. Both use the solver's
 * jobs. product = (K + rate M) direction, N; direction: m; rate: 1/s2, 0 or more. K: Hessian of U, projected unless
 * exact is not 0; M: the mass, lumped if the model says so. Springs, contact and damping belong to steps and are left
 * out; sleeping components are included. Directions of held copies and of copies without an element count as 0, and
 * followers move as their masters make them. The product is 0 on all of these; forces on followers go to their masters.
 * So the operator is symmetric, and semi-definite unless exact. Vectors are copy_count x 3 doubles. The Hessian, the
 * motion of an element's copies relative to its first one, and its forces are single precision; the differences are
 * taken in double precision, so that translations meet no stiffness at all. Sums over elements are single precision
 * within chunks, double between them. A direction times a power of two gives exactly its product times that power. The
 * operator lasts until the next step, update or model; without one, product is GX_ERROR_SEQUENCE. GX_ERROR_RANGE: the
 * Hessian is beyond single precision. Neither function allocates or changes what steps do. product may not overlap
 * direction. */
GXFEM_API gx_result gxs_solver_linearise(gxs_solver *solver, const double *displacement, double rate, uint32_t exact,
                                         gx_failure *failure);
GXFEM_API gx_result gxs_solver_product(gxs_solver *solver, const double *direction, double *product,
                                       gx_failure *failure);

/* Errors: ARGUMENT, MEMORY. */
GXFEM_API gx_result gxs_solver_create(const gxs_solver_desc *desc /* or NULL */, gxs_solver **solver,
                                      gx_failure *failure);
GXFEM_API void gxs_solver_destroy(gxs_solver *solver); /* NULL is allowed */

/* The material at one deformation gradient F (3x3 by rows; nothing is checked): energy density, J/m3, 0 at rest; first
 * Piola-Kirchhoff stress P = d energy / dF, Pa; projected Hessian dP/dF times direction, Pa, in single precision. */
GXFEM_API double gxs_material_energy(const gxs_material *material, const double *deformation);
GXFEM_API void gxs_material_stress(const gxs_material *material, const double *deformation, double *stress);
GXFEM_API void gxs_material_product(const gxs_material *material, const double *deformation, const double *direction,
                                    double *product);

#ifdef __cplusplus
}
#endif
/* Stop here for the API. */
#endif /* GXFEM_SOLVE_INCLUDED */

#if defined(GXFEM_IMPLEMENTATION) && !defined(GXFEM_SOLVE_IMPLEMENTATION)
#define GXFEM_SOLVE_IMPLEMENTATION
#endif
#if defined(GXFEM_SOLVE_IMPLEMENTATION) && !defined(GXFEM_SOLVE_IMPLEMENTED)
#define GXFEM_SOLVE_IMPLEMENTED

#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#if defined(GXFEM_INTRINSICS) && (defined(__SSE2__) || defined(_M_X64))
#include <emmintrin.h>
#elif defined(GXFEM_INTRINSICS) && (defined(__aarch64__) || defined(_M_ARM64))
#include <arm_neon.h>
#endif

#ifdef __cplusplus
extern "C" {
#endif
#ifdef GXFEM_SCALAR
#pragma clang attribute push(__attribute__((target("no-simd128"))), apply_to = function)
#endif

/* >>constants: sizes, limits and measured choices ------------------------------------------------------------------ */

/* In and out: nothing but macros and the types of vectors. For measured numbers, the comment names the models. */

/* Elements side by side in a block: whole vectors on every instruction set up to 512 bits of doubles */
#define GXSP_LANES 8

/* Blocks of a chunk: 384 elements, whose nodes (about 150) stay in the first-level cache. */
#define GXSP_CHUNK_BLOCKS 48
#define GXSP_CHUNK        (GXSP_CHUNK_BLOCKS * GXSP_LANES)

/* Passes copy the nodes of a chunk to the stack where there are no more than this: meshes of cubes have 125 to 165, cut
 * into pieces of an element's size 300. Other chunks, of elements that share few nodes, are read copy by copy. */
#define GXSP_NEAR         320
#define GXSP_NEAR_NUMBERS (3 * GXSP_NEAR + 1)

/* A residual below this (about 50 units in the last place) is rounding: no iteration can lower it. */
#define GXSP_ROUNDING 1e-14

/* Sufficient decrease in the line search, as a share of the decrease that the slope predicts [Nocedal and Wright,
 * Numerical Optimization]. */
#define GXSP_ARMIJO 1e-4

/* Newton's method ends after this many iterations in a row whose gain doubles cannot tell. */
#define GXSP_STALLS 4

/* The line search starts at the linear model's minimum along a direction that goes at least twice as far as that. */
#define GXSP_TOO_LONG 0.5

/* Trials of the line search. Each at least halves the step; after 60 it is below rounding. */
#define GXSP_TRIALS 60

/* No component, node, chunk or copy */
#define GXSP_NONE UINT32_MAX

/* States of a component. HELD: a copy of it is held. UNBALANCED: it has no mass, or constraints that do not follow
 * translations. TOUCHED: springs or contact have acted on it since Newton's method began. ASLEEP: it sleeps.
 * TOUCHES: springs or contact act on it at this linearisation. */
#define GXSP_HELD       1u
#define GXSP_UNBALANCED 2u
#define GXSP_TOUCHED    4u
#define GXSP_ASLEEP     8u
#define GXSP_TOUCHES    16u

/* If a cycle of the multigrid multiplies a residual's energy by this, rounding has made a coarse matrix senseless. */
#define GXSP_ABSURD 1e20

/* Gradients that differ from those of the rest positions by no more than this, relative to their largest entry, are
 * taken for rounded ones of these. */
#define GXSP_PLACED 1e-11

/* The midpoint rule's second half gains at most this share of the kinetic energy: exact solutions gain less where
 * steps resolve the motion. GXSP_GAIN_TRIALS lengths are tried. */
#define GXSP_GAIN        0.01
#define GXSP_GAIN_TRIALS 8

/* Single precision must hold weight times Hessian. Where the Hessian's entries relative to the moduli would exceed
 * GXSP_STRETCHED, the stretches are clamped, and the weight is scaled by the fourth power of the excess, the
 * fastest growth there is, up to GXSP_HEAVIEST, J. */
#define GXSP_STRETCHED 1e24
#define GXSP_HEAVIEST  1e12

/* A copy between parts of elements is light if its share of their mass is below GXSP_LIGHT (in whole elements the
 * share is 1/4), or its mass below GXSP_LIGHTER of a neighbour's. */
#define GXSP_LIGHT   0.1
#define GXSP_LIGHTER 0.02

/* Light copies start where the copies that guide them lead, and follow these in the midpoint rule's second half. They
 * may differ from them by GXSP_FREE of their distance from these. Slices of 1/15 of an element have such copies: where
 * steps resolve their motion, it stays within this share. */
#define GXSP_FREE 0.1

/* Directions of light copies are bounded in the first GXSP_BOUNDED iterations of a step, where that costs at most
 * GXSP_BOUND_COST of the slope of their component. */
#define GXSP_BOUNDED    8
#define GXSP_BOUND_COST 0.1

/* An element is collapsed if all its stretches are below GXSP_COLLAPSED: its forces vanish there. Directions are
 * found as if it were GXSP_NUDGE of its size. */
#define GXSP_COLLAPSED 1e-4
#define GXSP_NUDGE     0.1

/* Passes prefetch data that is in no order in memory this many nodes or slots ahead. */
#define GXSP_AHEAD 128

/* Passes prefetch the data of products, and that of forces and Hessians, which take longer, this many blocks ahead. */
#define GXSP_TANGENTS_AHEAD 8
#define GXSP_RESTS_AHEAD    2

/* Copies of one task of a pass over copies, and how many sums it may make */
#define GXSP_RANGE 512
#define GXSP_SUMS  6

/* Single precision cannot tell two guesses apart if the square of the sine of their angle, measured in energy, is
 * below this. */
#define GXSP_PARALLEL 1e-5

/* Explicit steps. Light copies get this share of the mass of all more: their own motion then allows substeps as long as
 * that of whole elements. On an accordion of cut cubes it doubles them, and changes the motion by 7e-4. */
#define GXSP_LEAP_MASS 0.003

/* The factor on L: the power method ends a little below the largest eigenvalue. Should a step create energy all the
 * same, the next factor, GXSP_LEAP_RAISE times as large, is tried, as many times as it takes to reach the last. */
#define GXSP_LEAP_FACTOR 1.1
#define GXSP_LEAP_RAISE  1.3
#define GXSP_LEAP_LAST   2.2

/* The degree of the filter at rest if substeps are not given: a product takes a third to a quarter of the time of
 * forces, and longer filters lose accuracy. The highest degree. The most substeps that a step takes by itself. */
#define GXSP_LEAP_DEGREE   3
#define GXSP_LEAP_DEGREES  24
#define GXSP_LEAP_SUBSTEPS 64

/* Steps by the error asked for. Of a motion of frequency w the midpoint rule's error after the time GXSP_QUALITY_TIME,
 * s, is GXSP_QUALITY_MIDPOINT (w h)^2 (w time + GXSP_QUALITY_MORE), BDF2's likewise, and backward Euler's
 * GXSP_QUALITY_EULER w h: fits to bench/front.c, within a factor of two on most of its bodies. Errors of up to
 * GXSP_QUALITY_COARSE begin with four implicit steps, larger ones with two. */
#define GXSP_QUALITY_TIME     0.33
#define GXSP_QUALITY_MIDPOINT 0.0275
#define GXSP_QUALITY_BDF2     0.3
#define GXSP_QUALITY_MORE     3.0
#define GXSP_QUALITY_EULER    0.4
#define GXSP_QUALITY_COARSE   0.03

/* The highest degree of the filter at rest, and the most substeps, that quality chooses. Longer filters save nothing:
 * what substeps save, products cost. */
#define GXSP_QUALITY_DEGREE   5
#define GXSP_QUALITY_SUBSTEPS 256

/* What an implicit step takes, and the rest of a step, in evaluations of explicit forces: measured on bodies of 1,000
 * to 24,000 unknowns, from 35 to 60. And what a product of the filter takes. */
#define GXSP_WORK_IMPLICIT 50.0
#define GXSP_WORK_STEP     10.0
#define GXSP_WORK_PRODUCT  0.3

/* Parts of a step that are quick, solved to a tolerance t: they err by GXSP_QUALITY_LEFT t^2, up to GXSP_QUALITY_LOOSE,
 * and take about 1 + 0.4 / t iterations (soft accordions of 1,458 to 37,650 unknowns: 0.3 to 1 times that error). In
 * bodies that move by more than a radian in a step, or need several for the error, or that explicit steps without a
 * filter would divide by more than GXSP_QUALITY_SOFT, what such a solve leaves hides the motion: a bar that needs two
 * was off by as much as it moves. Accordions need 28 to 89 such substeps. Work of a part, and of an iteration. */
#define GXSP_QUALITY_SOFT       100.0
#define GXSP_QUALITY_LEFT       0.3
#define GXSP_QUALITY_LOOSE      0.6
#define GXSP_QUALITY_ITERATIONS 12
#define GXSP_WORK_QUICK         5.0
#define GXSP_WORK_ITERATION     4.5

/* The frequency is measured in each implicit step, in each of the GXSP_QUALITY_FIRST first explicit steps, then in one
 * of GXSP_QUALITY_EACH. What was measured is forgotten by 1 / e after four radians, and by GXSP_QUALITY_FORGET powers
 * of e at most from one measure to the next: a motion that turns has no speed for a while. */
#define GXSP_QUALITY_EACH   4
#define GXSP_QUALITY_FIRST  2
#define GXSP_QUALITY_FORGET 2.0
#define GXSP_QUALITY_SLACK  1.2

/* Steps that are implicit after explicit ones have been refused with filters of each length */
#define GXSP_QUALITY_WAIT 30

/* Kinetic energy of so many times that of the mean velocity is that of vibrations that steps do not follow. */
#define GXSP_QUALITY_HIDDEN 4.0

/* What has been made for explicit and for quick steps */
#define GXSP_LEAP_BLOCKS 1
#define GXSP_LEAP_ALL    2

/* Quick steps that one linearisation serves at most, for the diagonal; coarse matrices have a life of their own. What a
 * component may be slowed down by if its energy has risen, as a share of its kinetic energy: beyond, less of the
 * midpoint rule's second half is tried, so many ends in all, or the step is not quick. Then linear systems are solved
 * to GXSP_QUICK_RETRY at least. */
#define GXSP_QUICK_AGE    64
#define GXSP_QUICK_CUT    0.2
#define GXSP_QUICK_TRIALS 4
#define GXSP_QUICK_RETRY  0.1

/* Rows in a group of the stiffness bound; divides GXSP_RANGE */
#define GXSP_LEAP_ROWS 4

/* Iterations of the power method for the largest eigenvalue */
#define GXSP_LEAP_POWERS 40

/* Energy may rise above its limit by this share of the elastic and kinetic energy. The limit is that of the start; it
 * nears the present energy by GXSP_LEAP_FORGET a step. */
#define GXSP_LEAP_GAIN   0.03
#define GXSP_LEAP_FORGET 0.1

/* Spacing of the first lattice of the multigrid, in edges of an average element. */
#define GXSP_SPACING 2.5

/* A component with more than GXSP_CROWDED nodes of the first lattice per copy gets fewer: its affine motions, which
 * are four nodes, if it is shorter than GXSP_AFFINE spacings along each axis; a lattice of twice the spacing if it
 * is shorter than GXSP_COARSE. Measured: 0.08 to 0.16 nodes per copy in bodies of one component, cut or not, 0.37
 * to 0.44 in components of 60 copies. */
#define GXSP_CROWDED 0.25f
#define GXSP_AFFINE  2
#define GXSP_COARSE  3

/* In components of fewer copies block-Jacobi is at least as fast as multigrid. For nearly incompressible ones the
 * bound is lower. */
#define GXSP_MULTIGRID_FROM       150
#define GXSP_MULTIGRID_FROM_STIFF 60
#define GXSP_STIFF_POISSON        0.48

/* A level is factored if that takes at most this many multiplications per copy (level 1: half of that, since it
 * takes most memory), or if the next level would not be smaller by a third. Slender bodies need it: coarser levels
 * hardly bend with them, and an exact solution two levels down saves two iterations in three. */
#define GXSP_FACTOR_COST 3000
#define GXSP_LEVELS      12

/* Where copies are affine, level 1 is factored if that takes at most GXSP_NESTED_COST times as much; else its lattice
 * is widened, up to GXSP_WIDEST times. It starts from GXSP_NESTED_FROM of the usual spacing. */
#define GXSP_NESTED_COST 12
#define GXSP_NESTED_FROM 0.8f
#define GXSP_WIDEST      8

/* Some fields have many descriptions by affine copies, and rounding alone would choose among them. Level 1 ties A to
 * the gradient around it, by this share of the stiffness (>>nesting), and steps start from where it is so much closer
 * to that (>>balance). With ties of 1e-3 clamped slabs take twice the iterations; with 1e-6 rounding moves A thirty
 * times as far in slices that are pressed. */
#define GXSP_TIE  1e-4
#define GXSP_CALM 0.1

/* An update keeps that lattice while its factor takes at most so many times as much. */
#define GXSP_NESTED_SLACK 2

/* Elements of affine copies: blocks of one task; and of one round, after which the results are summed, so that these
 * take memory for one round only. Sums go by blocks, whatever the threads do. */
#define GXSP_AFFINE_TASK  8
#define GXSP_AFFINE_ROUND 64

/* Iterations whose gain tells how far conjugate gradients are where copies are affine */
#define GXSP_GAINS 3

/* Thin sheets that are flung turn far in a step, and the first iterations stretch them. Where the caller gives no
 * number, iterations go on until one moves affine copies by less than this share of their motion in the step; this many
 * at most. Measured on slices of 1/15 and 1/5 of an element in steps of 17 and 33 ms: motion within 4 % of converged
 * steps. Twice the share: 12 %. */
#define GXSP_SETTLED     0.01
#define GXSP_SHEETS_MOST 40

/* Block-Jacobi takes less time than multigrid where inertia's mean share of the Hessian's diagonal blocks is larger
 * than this: few iterations, as the share bounds the spectrum from below. Measured on blocks of 2,000 to 8,000
 * copies, cut and not, lattice and jittered, E of 1e6 and 1e8: as long as multigrid at a share of 0.015 to 0.06,
 * 0.8 to 1 times as long above, 1.1 to 2.7 times at 0.005 and below. */
#define GXSP_INERTIA 0.03

/* The same in components under pairs: coarse levels hardly know of these, and multigrid takes three times as many
 * iterations with them, block-Jacobi one and a half times to twice as many. Measured on two blocks of 2,197 copies, one
 * on the other, 864 pairs of 10 E / h per area: multigrid takes 1.7 times as long at E = 1e5 and steps of 1/60 s, as
 * long at 1e6, 0.9 times at 1e7. */
#define GXSP_INERTIA_PAIRED 0.003

/* The diagonals of the multigrid's matrices grow by this share, so that they stay positive definite in single
 * precision. */
#define GXSP_SHIFT 1e-5f

/* Binary exponent of a whole element's stiffness in the linear systems: leaves room for components down to 1e-40 of
 * it, and for masses above. */
#define GXSP_STIFFNESS 40

/* Making coarse matrices costs as much as GXSP_REMAKE iterations. The first ones of a model serve for GXSP_LIFE
 * iterations. Comparison with new ones then shows the cost of their age. If it is less than GXSP_AGEING of the pace,
 * the next ones serve GXSP_PATIENCE times as long. */
#define GXSP_REMAKE   5
#define GXSP_LIFE     40
#define GXSP_AGEING   0.2
#define GXSP_PATIENCE 2

/* After a cut, coarse numbers are made for entries of dirty nodes only, unless a larger share of chunks than this
 * follows dirty nodes: those chunks' Hessians are computed at the state of the other numbers, for this purpose only. */
#define GXSP_DIRTY 0.6

/* Iterations, of several solves if need be, over which the pace of conjugate gradients is measured. */
#define GXSP_READING 10

/* Coarse matrices are worn when iterations are this many times slower than at first. */
#define GXSP_WORN 2

/* Bound on the smoother's step length times the largest eigenvalue met. At 2 the cycle would be indefinite; the
 * eigenvalue is known to a tenth. */
#define GXSP_OMEGA 1.75

/* Linear solves for which the smoother's step length stays the safe one after it has proved too large. Twice as
 * many each further time. */
#define GXSP_PAUSE 8

/* A diagonal block of less stiffness in the linear systems has no inverse in single precision: it is left alone. */
#define GXSP_TINY 1e-28

/* A chunk with at most this many coarse nodes has a table of matrix entries. With more, each entry is searched for. */
#define GXSP_CHUNK_PARENTS 192

/* Arrays begin at multiples of this many bytes: no vector lies across two cache lines. */
#define GXSP_ALIGNMENT 64

/* Bits of the filter of changed groups; a power of two. */
#define GXSP_FILTER 65536u

/* Groups of elements are below this: gxsp_sort sorts by 30 bits. */
#define GXSP_GROUPS ((uint32_t)1 << 30)

/* Arrays of a block's passes never overlap. cl knows C's own word only if it is told the standard. */
#if defined(__GNUC__) || defined(_MSC_VER)
#define GXSP_RESTRICT __restrict
#elif !defined(__cplusplus)
#define GXSP_RESTRICT restrict
#else
#define GXSP_RESTRICT
#endif

/* INLINE: compilers must know the column numbers. Columns that might be equal are not vectorised. COLD: seldom called,
 * kept out of line and compiled for size. APART: kept out of line, so that its arrays are not in the frame of what
 * calls it: a frame has at most 16 kB. */
#if defined(__GNUC__) || defined(__clang__)
#define GXSP_COLD   __attribute__((cold, noinline))
#define GXSP_APART  __attribute__((noinline))
#define GXSP_INLINE static inline __attribute__((always_inline))
#elif defined(_MSC_VER)
#define GXSP_COLD   __declspec(noinline)
#define GXSP_APART  __declspec(noinline)
#define GXSP_INLINE static __forceinline
#else
#define GXSP_COLD
#define GXSP_APART
#define GXSP_INLINE static inline
#endif

/* Loops over the lanes of a block, and of two. Clang is told not to unroll them: it would unroll before it
 * vectorises. */
#if defined(__clang__)
#define GXSP_EACH(l, count) _Pragma("clang loop unroll(disable)") for (l = 0; l < (count); l++)
#elif defined(__GNUC__)
#define GXSP_EACH(l, count) _Pragma("GCC ivdep") for (l = 0; l < (count); l++)
#elif defined(_MSC_VER)
#define GXSP_EACH(l, count) __pragma(loop(ivdep)) for (l = 0; l < (count); l++)
#else
#define GXSP_EACH(l, count) for (l = 0; l < (count); l++)
#endif
#define GXSP_EACH_LANE(l)   GXSP_EACH(l, GXSP_LANES)
#define GXSP_EACH_OF_TWO(l) GXSP_EACH(l, 2 * GXSP_LANES)

/* clang-format off */
/* Vectors for code that compilers do not vectorise: shuffles of nodes' vectors and blocks, many sums at a time. They
 * come from the compiler's own extensions, or from intrinsics of SSE2 or NEON. Elsewhere GXSP_SHUFFLES is not defined,
 * and plain C takes their place. Macros, since compilers warn of functions that take vectors the target lacks.
 *   FILLED     declares a vector of four equal numbers; with x87 the number itself would become a long double, by
 *              which no vector can be multiplied
 *   ZIP_LOW    a0 b0 a1 b1;  ZIP_HIGH: a2 b2 a3 b3
 *   JOIN_LOW   a0 a1 b0 b1;  JOIN_HIGH: a2 a3 b2 b3
 *   HALVES     a[i] a[j] b[k] b[l]
 *   ADD_LOW    adds the first two numbers to those at to;  ADD_HIGH: the last two
 *   EVENS      x0 y0 of two pairs of doubles;  ODDS: x1 y1
 *   NARROW     four doubles less four others, as floats
 *   DOUBLES    how many doubles a gxsp_doubles holds
 * Shuffles of vectors longer than the machine's are compiled number by number. Hence vectors of eight floats with AVX
 * only. */
#if defined(GXFEM_SCALAR)
#elif defined(GXFEM_INTRINSICS) && (defined(__SSE2__) || defined(_M_X64))
#define GXSP_SHUFFLES
#define GXSP_DOUBLES                  2
typedef __m128 gxsp_four;
typedef __m128d gxsp_pair;
typedef __m128d gxsp_doubles;
#define GXSP_LOAD(x)                  _mm_loadu_ps(x)
#define GXSP_STORE(to, a)             _mm_storeu_ps(to, a)
#define GXSP_FILLED(a, number)        const gxsp_four a = _mm_set1_ps(number)
#define GXSP_PLUS(a, b)               _mm_add_ps(a, b)
#define GXSP_TIMES(a, b)              _mm_mul_ps(a, b)
#define GXSP_ZIP_LOW(a, b)            _mm_unpacklo_ps(a, b)
#define GXSP_ZIP_HIGH(a, b)           _mm_unpackhi_ps(a, b)
#define GXSP_JOIN_LOW(a, b)           _mm_movelh_ps(a, b)
#define GXSP_JOIN_HIGH(a, b)          _mm_movehl_ps(b, a)
#define GXSP_HALVES(a, b, i, j, k, l) _mm_shuffle_ps(a, b, _MM_SHUFFLE(l, k, j, i))
#define GXSP_ADD_LOW(to, a)                                                                                            \
    _mm_storel_pi((__m64 *)(void *)(to),                                                                               \
                  _mm_add_ps(a, _mm_loadl_pi(_mm_setzero_ps(), (const __m64 *)(const void *)(to))))
#define GXSP_ADD_HIGH(to, a)                                                                                           \
    _mm_storeh_pi((__m64 *)(void *)(to),                                                                               \
                  _mm_add_ps(a, _mm_loadh_pi(_mm_setzero_ps(), (const __m64 *)(const void *)(to))))
#define GXSP_LOAD_PAIR(x)      _mm_loadu_pd(x)
#define GXSP_STORE_PAIR(to, x) _mm_storeu_pd(to, x)
#define GXSP_EVENS(x, y)       _mm_unpacklo_pd(x, y)
#define GXSP_ODDS(x, y)        _mm_unpackhi_pd(x, y)
#define GXSP_NARROW(x, y)                                                                                              \
    _mm_movelh_ps(_mm_cvtpd_ps(_mm_sub_pd(_mm_loadu_pd(x), _mm_loadu_pd(y))),                                          \
                  _mm_cvtpd_ps(_mm_sub_pd(_mm_loadu_pd((x) + 2), _mm_loadu_pd((y) + 2))))
#define GXSP_NO_DOUBLES             _mm_setzero_pd()
#define GXSP_LOAD_DOUBLES(x)        _mm_loadu_pd(x)
#define GXSP_WIDEN(a)               _mm_cvtps_pd(_mm_loadl_pi(_mm_setzero_ps(), (const __m64 *)(const void *)(a)))
#define GXSP_ADD_PRODUCT(sum, x, y) ((sum) = _mm_add_pd(sum, _mm_mul_pd(x, y)))
#define GXSP_SUM_DOUBLES(x)         _mm_cvtsd_f64(_mm_add_sd(x, _mm_unpackhi_pd(x, x)))
#elif defined(GXFEM_INTRINSICS) && (defined(__aarch64__) || defined(_M_ARM64))
#define GXSP_SHUFFLES
#define GXSP_DOUBLES           2
typedef float32x4_t gxsp_four;
typedef float64x2_t gxsp_pair;
typedef float64x2_t gxsp_doubles;
#define GXSP_LOAD(x)           vld1q_f32(x)
#define GXSP_STORE(to, a)      vst1q_f32(to, a)
#define GXSP_FILLED(a, number) const gxsp_four a = vdupq_n_f32(number)
#define GXSP_PLUS(a, b)        vaddq_f32(a, b)
#define GXSP_TIMES(a, b)       vmulq_f32(a, b)
#define GXSP_ZIP_LOW(a, b)     vzip1q_f32(a, b)
#define GXSP_ZIP_HIGH(a, b)    vzip2q_f32(a, b)
#define GXSP_JOIN_LOW(a, b)    vcombine_f32(vget_low_f32(a), vget_low_f32(b))
#define GXSP_JOIN_HIGH(a, b)   vcombine_f32(vget_high_f32(a), vget_high_f32(b))
#define GXSP_HALVES(a, b, i, j, k, l)                                                                                  \
    vcopyq_laneq_f32(vcopyq_laneq_f32(vcopyq_laneq_f32(vdupq_laneq_f32(a, i), 1, a, j), 2, b, k), 3, b, l)
#define GXSP_ADD_LOW(to, a)    vst1_f32(to, vadd_f32(vld1_f32(to), vget_low_f32(a)))
#define GXSP_ADD_HIGH(to, a)   vst1_f32(to, vadd_f32(vld1_f32(to), vget_high_f32(a)))
#define GXSP_LOAD_PAIR(x)      vld1q_f64(x)
#define GXSP_STORE_PAIR(to, x) vst1q_f64(to, x)
#define GXSP_EVENS(x, y)       vzip1q_f64(x, y)
#define GXSP_ODDS(x, y)        vzip2q_f64(x, y)
#define GXSP_NARROW(x, y)                                                                                              \
    vcombine_f32(vcvt_f32_f64(vsubq_f64(vld1q_f64(x), vld1q_f64(y))),                                                  \
                 vcvt_f32_f64(vsubq_f64(vld1q_f64((x) + 2), vld1q_f64((y) + 2))))
#define GXSP_NO_DOUBLES             vdupq_n_f64(0)
#define GXSP_LOAD_DOUBLES(x)        vld1q_f64(x)
#define GXSP_WIDEN(a)               vcvt_f64_f32(vld1_f32(a))
#define GXSP_ADD_PRODUCT(sum, x, y) ((sum) = vfmaq_f64(sum, x, y))
#define GXSP_SUM_DOUBLES(x)         vaddvq_f64(x)
#elif (defined(__clang__) || (defined(__GNUC__) && __GNUC__ >= 12)) && !defined(GXFEM_INTRINSICS)
#define GXSP_SHUFFLES
#define GXSP_DOUBLES 4
typedef __attribute__((vector_size(8), aligned(4), may_alias)) float gxsp_two;
typedef __attribute__((vector_size(16), aligned(4), may_alias)) float gxsp_four;
typedef __attribute__((vector_size(16), aligned(8), may_alias)) double gxsp_pair;
typedef __attribute__((vector_size(32), aligned(8), may_alias)) double gxsp_doubles;
#if defined(__AVX__)
#define GXSP_AVX
typedef __attribute__((vector_size(32), aligned(4), may_alias)) float gxsp_eight;
#endif
#define GXSP_LOAD(x)                  (*(const gxsp_four *)(x))
#define GXSP_STORE(to, a)             (*(gxsp_four *)(to) = (a))
#define GXSP_FILLED(a, number)        const gxsp_four a = {number, number, number, number}
#define GXSP_PLUS(a, b)               ((a) + (b))
#define GXSP_TIMES(a, b)              ((a) * (b))
#define GXSP_ZIP_LOW(a, b)            __builtin_shufflevector(a, b, 0, 4, 1, 5)
#define GXSP_ZIP_HIGH(a, b)           __builtin_shufflevector(a, b, 2, 6, 3, 7)
#define GXSP_JOIN_LOW(a, b)           __builtin_shufflevector(a, b, 0, 1, 4, 5)
#define GXSP_JOIN_HIGH(a, b)          __builtin_shufflevector(a, b, 2, 3, 6, 7)
#define GXSP_HALVES(a, b, i, j, k, l) __builtin_shufflevector(a, b, i, j, 4 + (k), 4 + (l))
#define GXSP_ADD_LOW(to, a)           (*(gxsp_two *)(to) += __builtin_shufflevector(a, a, 0, 1))
#define GXSP_ADD_HIGH(to, a)          (*(gxsp_two *)(to) += __builtin_shufflevector(a, a, 2, 3))
#define GXSP_LOAD_PAIR(x)             (*(const gxsp_pair *)(x))
#define GXSP_STORE_PAIR(to, x)        (*(gxsp_pair *)(to) = (x))
#define GXSP_EVENS(x, y)              __builtin_shufflevector(x, y, 0, 2)
#define GXSP_ODDS(x, y)               __builtin_shufflevector(x, y, 1, 3)
#define GXSP_NARROW(x, y)                                                                                              \
    __builtin_convertvector(*(const gxsp_doubles *)(x) - *(const gxsp_doubles *)(y), gxsp_four)
#define GXSP_NO_DOUBLES             {0, 0, 0, 0}
#define GXSP_LOAD_DOUBLES(x)        (*(const gxsp_doubles *)(x))
#define GXSP_WIDEN(a)               __builtin_convertvector(*(const gxsp_four *)(a), gxsp_doubles)
#define GXSP_ADD_PRODUCT(sum, x, y) ((sum) += (x) * (y))
#define GXSP_SUM_DOUBLES(x)         (((x)[0] + (x)[2]) + ((x)[1] + (x)[3]))
#endif
/* clang-format on */

/* One number per element of a block */
typedef double gxsp_lanes[GXSP_LANES];
typedef float gxsp_singles[GXSP_LANES];

/* >>scalars: bits, sums, functions of one number ------------------------------------------------------------------- */

/* Functions of numbers and arrays of numbers only. Finiteness is read off the bits, since comparisons with NaN
 * mean nothing under -ffast-math. Compilers turn these functions into vector instructions; they leave sqrt alone
 * for the sake of errno. */

static int gxsp_finite(double value) {
    uint64_t bits;
    memcpy(&bits, &value, sizeof bits);
    return ((bits >> 52) & 0x7ff) != 0x7ff;
}

static int gxsp_finite_single(float value) {
    uint32_t bits;
    memcpy(&bits, &value, sizeof bits);
    return ((bits >> 23) & 0xff) != 0xff;
}

/* Index of the first value that is NaN or infinite; count if there is none. */
static size_t gxsp_first_not_finite(const double *values, size_t count) {
    size_t i;
    for (i = 0; i < count; i++)
        if (!gxsp_finite(values[i])) break;
    return i;
}

static int gxsp_all_finite_single(const void *numbers, size_t bytes) {
    const float *number = (const float *)numbers;
    size_t i;
    for (i = 0; i < bytes / sizeof *number; i++)
        if (!gxsp_finite_single(number[i])) return 0;
    return 1;
}

/* A result that blames nothing that was given: success, or a lack of memory */
static gx_result gxsp_end(gx_failure *failure, gx_result result) {
    failure->result = result;
    failure->field = NULL;
    failure->index = failure->surface = SIZE_MAX;
    return result;
}

static GXSP_COLD gx_result gxsp_fail(gx_failure *failure, gx_result result, const char *field, size_t index) {
    gxsp_end(failure, result);
    failure->field = field;
    failure->index = index;
    return result;
}

/* 3-vectors a[3 count], b[3 count]; three sums, so that no addition waits for the one before it */
static double gxsp_dot(const double *a, const double *b, size_t count) {
    double x = 0, y = 0, z = 0;
    size_t i;
    for (i = 0; i < count; i++) {
        x += a[3 * i] * b[3 * i];
        y += a[3 * i + 1] * b[3 * i + 1];
        z += a[3 * i + 2] * b[3 * i + 2];
    }
    return x + y + z;
}

/* sum of a[i] b[i] in eight sums side by side, for vectors */
static double gxsp_long_dot(const float *a, const double *b, size_t count) {
    double sum[8] = {0, 0, 0, 0, 0, 0, 0, 0};
    size_t i, k;
    for (i = 0; i + 8 <= count; i += 8)
        for (k = 0; k < 8; k++) sum[k] += (double)a[i + k] * b[i + k];
    for (; i < count; i++) sum[0] += (double)a[i] * b[i];
    return ((sum[0] + sum[4]) + (sum[1] + sum[5])) + ((sum[2] + sum[6]) + (sum[3] + sum[7]));
}

/* index of entry (i, j), i <= j, of a symmetric 3x3 stored 00 01 02 11 12 22, and of a 9x9 alike */
static int gxsp_packed3(int i, int j) { return i * (5 - i) / 2 + j; }

static int gxsp_packed9(int i, int j) { return i <= j ? i * (17 - i) / 2 + j : j * (17 - j) / 2 + i; }

/* 1 / sqrt(x) of a normal x > 0, to 3 units in the last place: halves the exponent, then Newton's method. */
static inline float gxsp_rsqrt(float x) {
    uint32_t bits;
    float y;
    memcpy(&bits, &x, sizeof bits);
    bits = 0x5f375a86u - (bits >> 1);
    memcpy(&y, &bits, sizeof y);
    y = y * (1.5f - 0.5f * x * y * y);
    y = y * (1.5f - 0.5f * x * y * y);
    return y * (1.5f - 0.5f * x * y * y);
}

/* x - log(1 + x) for x >= -3/4 without cancellation. 1 + x = 2^k (1 + w), 1 + w in [sqrt 1/2, sqrt 2).
 * With z = w / (2 + w): w - log(1 + w) = w z - 2 z^3 (1/3 + z^2/5 + z^4/7 + ...), |z| < 0.172.
 * The first term left out is below 1e-17 w^2. */
static inline double gxsp_log_rest(double x) {
    const double y = 1 + x;
    uint64_t bits, exponent;
    double k, m, w, z, q;
    memcpy(&bits, &y, sizeof bits);
    exponent = (bits - 0x3fe6a09e667f3bcdu + ((uint64_t)1024 << 52)) >> 52; /* k + 1024 */
    bits -= (exponent - 1024) << 52;
    exponent |= (uint64_t)0x433 << 52; /* 2^52 + k + 1024 */
    memcpy(&m, &bits, sizeof m);
    memcpy(&k, &exponent, sizeof k);
    k -= 4503599627370496.0 + 1024.0;
    w = k < 0 || k > 0 ? m - 1 : x;
    z = w / (2 + w);
    q = z * z;
    return w * z -
           2 * z * q *
               (1.0 / 3 +
                q * (1.0 / 5 +
                     q * (1.0 / 7 +
                          q * (1.0 / 9 +
                               q * (1.0 / 11 +
                                    q * (1.0 / 13 +
                                         q * (1.0 / 15 +
                                              q * (1.0 / 17 + q * (1.0 / 19 + q * (1.0 / 21 + q / 23)))))))))) +
           (x - w - k * 0.69314718055994531);
}

/* The larger magnitude */
static inline float gxsp_larger(float a, float b) {
    const float x = a < 0 ? -a : a, y = b < 0 ? -b : b;
    return x > y ? x : y;
}

/* An entry beside others of size 1; 0 if it is far below their rounding in single precision. Powers of such entries
 * would be denormal, which cost processors a hundred cycles. Falling bodies have many. */
GXSP_INLINE float gxsp_clean(float entry) { return entry < 1e-9f && entry > -1e-9f ? 0.0f : entry; }

/* 2^k, |k| < 1023, about the inverse of the largest value's size: single precision holds the values times that, and
 * their product. 0: a value is not finite. */
static double gxsp_unit_factor(const double *values, size_t count) {
    const uint64_t exponent = (uint64_t)0x7ff << 52, one = (uint64_t)1 << 52;
    uint64_t largest = one, bits;
    double factor;
    size_t i;
    for (i = 0; i < count; i++) {
        memcpy(&bits, &values[i], sizeof bits);
        largest = (bits & exponent) > largest ? bits & exponent : largest;
    }
    if (largest == exponent) return 0;
    bits = 2046 * one - (largest < 2045 * one ? largest : 2045 * one);
    memcpy(&factor, &bits, sizeof factor);
    return factor;
}

/* Hash of values appended to a hash; never 0, and 1 for no values */
static uint64_t gxsp_hash(uint64_t hash, const double *values, size_t count) {
    size_t i;
    for (i = 0; i < count; i++) {
        uint64_t bits;
        memcpy(&bits, &values[i], sizeof bits);
        hash = (hash ^ bits) * 0x9e3779b97f4a7c15u;
        hash ^= hash >> 29;
    }
    return hash | 1;
}

static int gxsp_differs(const double *a, const double *b) { return memcmp(a, b, 3 * sizeof *a) != 0; }

/* >>memory: pools -------------------------------------------------------------------------------------------------- */

/* In: the caller's allocator. Every array of the solver belongs to a pool and is zero when it is taken. There is
 * one way to grow: gxsp_grow takes a larger array, copies what is kept and gives the old one back; gxsp_room says
 * how large. Arrays that are never needed at the same time lie in one allocation, which a gxsp_space cuts into
 * arrays. */

static void *gxsp_malloc(void *user, size_t size) {
    (void)user;
    return malloc(size);
}

static void gxsp_free(void *user, void *memory, size_t size) {
    (void)user;
    (void)size;
    free(memory);
}

/* Head of an allocation of a pool; the memory follows it, at the next multiple of GXSP_ALIGNMENT. */
typedef struct gxsp_owned {
    struct gxsp_owned *next;
    size_t size; /* with this head */
} gxsp_owned;

/* Allocations that are given back together */
typedef struct gxsp_pool {
    gx_allocator allocator;
    gxsp_owned *last;
    int failed; /* an allocation returned NULL */
} gxsp_pool;

static void *gxsp_memory(gxsp_owned *owned) {
    unsigned char *memory = (unsigned char *)(owned + 1);
    return memory + (GXSP_ALIGNMENT - (uintptr_t)memory % GXSP_ALIGNMENT) % GXSP_ALIGNMENT;
}

/* count x size bytes, zero. NULL, and failed is set, if there is no memory. Callers check failed once, at their end. */
static void *gxsp_take(gxsp_pool *pool, size_t count, size_t size) {
    gxsp_owned *owned;
    size_t bytes = (count > 0 ? count : 1) * size;
    if (pool->failed) return NULL;
    owned = (gxsp_owned *)pool->allocator.allocate(pool->allocator.user, sizeof *owned + GXSP_ALIGNMENT + bytes);
    if (!owned) {
        pool->failed = 1;
        return NULL;
    }
    owned->next = pool->last;
    owned->size = sizeof *owned + GXSP_ALIGNMENT + bytes;
    pool->last = owned;
    return memset(gxsp_memory(owned), 0, bytes);
}

/* Replaces an array by one of room x size bytes, keeps its first used x size bytes and gives the old one back.
 * memory NULL: there is none yet. Returns NULL, and the old array stays, if there is no memory. */
static void *gxsp_grow(gxsp_pool *pool, void *memory, size_t used, size_t room, size_t size) {
    void *larger = gxsp_take(pool, room, size);
    gxsp_owned **link = &pool->last, *owned;
    if (!larger || !memory) return larger;
    memcpy(larger, memory, used * size);
    while (gxsp_memory(*link) != memory) link = &(*link)->next;
    owned = *link;
    *link = owned->next;
    pool->allocator.release(pool->allocator.user, owned, owned->size);
    return larger;
}

/* Gives back everything taken since mark was pool->last. */
static void gxsp_release_to(gxsp_pool *pool, gxsp_owned *mark) {
    while (pool->last != mark) {
        gxsp_owned *owned = pool->last;
        pool->last = owned->next;
        pool->allocator.release(pool->allocator.user, owned, owned->size);
    }
}

/* The room that an array of count entries gets when it grows, so that it seldom grows */
static size_t gxsp_room(size_t count) { return count + count / 8; }

static gxsp_pool gxsp_pool_make(const gx_allocator *allocator) {
    gxsp_pool pool;
    pool.allocator = *allocator;
    pool.last = NULL;
    pool.failed = 0;
    return pool;
}

/* One allocation that is cut into arrays, one after the other */
typedef struct gxsp_space {
    unsigned char *memory; /* NULL: arrays are only counted */
    size_t used;
} gxsp_space;

/* The next array of a space: count x size bytes; NULL if the space has no memory and only counts. */
static void *gxsp_carve(gxsp_space *space, size_t count, size_t size) {
    const size_t start = space->used;
    space->used = start + (count * size + GXSP_ALIGNMENT - 1) / GXSP_ALIGNMENT * GXSP_ALIGNMENT;
    return space->memory ? space->memory + start : NULL;
}

/* >>structs: the solver's own form of a model ---------------------------------------------------------------------- */

/* In and out: types only. A model is elements in lanes, lanes in blocks, blocks in chunks; copies have a slot in
 * each chunk that they are in. gxsp_system is divided by lifetime. The comment on an array says its shape, its
 * unit and when it is valid. */

/* Constants of a block's elements. A lane without an element has weight, mass and gradients 0 and names nodes of
 * the chunk, to which it adds zeros. */
typedef struct gxsp_rest {
    double weight[GXSP_LANES]; /* m3 */
    /* kg: m of the block m (1 + delta_ij); the element's mass in chunks that have moments */
    double mass[GXSP_LANES];
    uint32_t material[GXSP_LANES];
} gxsp_rest;

/* Gradients of shape functions 1 ... 3 of a block, by rows, 1/m. Only where they differ from those of the rest
 * positions */
typedef struct gxsp_gradients {
    double entry[9][GXSP_LANES];
} gxsp_gradients;

/* Nodes of a block, numbered in its chunk. Apart from gxsp_rest, because products need nothing else */
typedef struct gxsp_corners {
    uint16_t node[4][GXSP_LANES];
} gxsp_corners;

/* Moments of the mass of a part of an element: M_ij = mass (c_i c_j + R_i . R_j), semi-definite however it is rounded,
 * for slivers too. c: centre of mass in barycentric coordinates; R R^T: their covariance; c_0 = 1 - sum c, R_0 = -sum
 * R. */
typedef struct gxsp_moments {
    float centre[3][GXSP_LANES]; /* of corners 1 ... 3, in whole units of 2^-24: exactly 1 in sum with c_0 */
    float root[6][GXSP_LANES];   /* of corners 1 ... 3, lower triangle by rows */
} gxsp_moments;

/* Projected Hessian of a block: dP = U (h : U^T dF V) V^T. */
typedef struct gxsp_tangent {
    /* U of F = U S V^T as sqrt 2 times its unit quaternion: x, y, z, w. Any four numbers give a symmetric Hessian */
    float frame[4][GXSP_LANES];
    float gradient[9][GXSP_LANES]; /* shape function gradients 1..3 times V, by rows, 1/m */
    float stretch[6][GXSP_LANES];  /* weight x h: stretches; J */
    float even[3][GXSP_LANES];     /* factor of an off-diagonal entry (12), (20), (01) to itself; J */
    float odd[3][GXSP_LANES];      /* factor of an off-diagonal entry to its mirror; J */
    float mass[GXSP_LANES];        /* gxsp_rest.mass x rate, kg/s2 */
} gxsp_tangent;

/* Projected Hessian of a block of GXS_CUSTOM, which has no frame (U and V are 1): weight x dP_i/dF_j, upper
 * triangle by rows; J */
typedef struct gxsp_general {
    float hessian[45][GXSP_LANES];
} gxsp_general;

/* Entries of the assembled matrix to which a block's corners i <= j add, in the order of gxs_element.mass. Row: the
 * lower copy */
typedef struct gxsp_fine {
    uint32_t entry[10][GXSP_LANES]; /* GXSP_NONE: a corner follows others */
} gxsp_fine;

/* A chunk's energies of one component */
typedef struct gxsp_partial {
    double energies[3]; /* of the last pass: elastic, kinetic, size of the terms that were summed; J */
    uint32_t component;
} gxsp_partial;

typedef struct gxsp_chunk {
    gxsp_rest *rest; /* block_count, like every array here without a count of its own */
    gxsp_corners *corners;
    /* block_count + 1: bit i: some lane's corner i differs from that of the block before; behind the last block all
     * bits */
    uint8_t *changed;
    gxsp_tangent *tangents;
    gxsp_gradients *gradients; /* NULL: passes compute them from the rest positions */
    gxsp_moments *moments;     /* NULL: elements are whole, or masses lumped */
    gxsp_general *generals;    /* GXS_CUSTOM only; NULL: gxsp_tangent has the Hessians */
    /* block_count x GXSP_LANES: group of the element in each lane; GXSP_NONE: there is none */
    uint32_t *groups;
    uint32_t first_block, block_count;     /* blocks are counted through all chunks */
    uint32_t first_node, node_count;       /* into nodes and slots */
    uint32_t first_partial, partial_count; /* into partials: one per component of its nodes, ascending */
    uint32_t class_index;                  /* see gxsp_class */
    uint32_t edge_count;                   /* see gxsp_edges; 0: not known */
    uint32_t pair_count;                   /* see gxsp_pairs; at least; 0: not known */
    uint8_t dirty;                         /* of an update: a node has a dirty parent */
    int open;                              /* made by an update, with room for GXSP_CHUNK_BLOCKS */
    gxs_material_kind kind;
} gxsp_chunk;

/* A vector over copies in single precision is n x 4: one load per copy. The fourth number is unused. */
typedef float gxsp_vector4[4];

/* A level of the multigrid. Level 0 is the model. Transfer: value of node i = sum of weight[i][k] x value of
 * parent[i][k]. */
typedef struct gxsp_level {
    uint32_t n;
    int32_t (*place)[3];   /* n: lattice point; not of level 0 */
    uint32_t (*parent)[4]; /* n: nodes of the next level, GXSP_NONE where the weight is 0 */
    float (*weight)[4];
    /* n + 1: rows of the symmetric matrix on and above its diagonal; not of level 0 if it is matrix-free */
    uint32_t *start;
    uint32_t *column; /* ascending in a row; the first is the diagonal */
    /* 9 per entry, by columns. The last level, unless it is level 1, has it in shared memory, between gxsp_lend_memory
     * and gxsp_return_memory
     */
    float *block;
    float *inverse; /* n x 6: of the diagonal blocks, packed */
    /* n: solution, right-hand side, residual; those of level 0 are vectors of gxsp_vectors. The last level has no
     * parents, weights, inverses and residual */
    gxsp_vector4 *x, *b, *r;
} gxsp_level;

/* Edges: pairs of a chunk's nodes, i < j, that share an element, numbered from 1. */
typedef struct gxsp_edges {
    size_t table_size;
    /* table_size, nodes (nodes - 1) / 2 of the largest chunk: the edge of two nodes i < j, at j (j - 1) / 2 + i. Valid
     * if ends agrees; otherwise an edge of another chunk */
    uint16_t *table;
    uint32_t *ends;         /* i << 16 | j */
    float (*block)[9];      /* i's row and j's column of the Hessian, by columns */
    uint16_t *first, *next; /* the edges to higher nodes as a list: first by node, next by edge; 0: there is none */
    uint8_t *joined;        /* by node: it has an edge */
    uint32_t nodes, count;  /* count: with edge 0, which collects what no edge needs */
    uint16_t (*element)[6][GXSP_LANES]; /* by block: edges of its elements */
    float (*own)[9];                    /* by node: half its diagonal block, see gxsp_half_row */
    float *mass;                        /* by node: half the row sum of the mass, scaled, kg/s2 */
    uint16_t (*parent)[4];              /* by node: numbers of its parents, see gxsp_pairs */
    /* by number: a node's row of half the Hessian times the transfer; 0 between rows */
    float (*half)[9];
    uint16_t *touched; /* numbers in half that are not 0 */
} gxsp_edges;

/* Pairs of coarse nodes that are parents of one chunk's nodes, and their entries of level 1's matrix. Coarse nodes
 * are numbered in the chunk from 1; number 0 stands for no parent. */
typedef struct gxsp_pairs {
    /* count x count, if count is at most GXSP_CHUNK_PARENTS: 2 x the entry, + 1 if it is the entry of the transposed
     * pair */
    uint32_t *entry;
    uint32_t *local; /* by coarse node: its number in the chunk. gxsp_lower_numbers has it as scratch */
    uint32_t *node;  /* by number: the coarse node. gxsp_coarsen lists nodes of the next level in it */
    uint32_t *seen;  /* by number, in gxsp_coarsen by node: the row, plus 1, that touched it last */
    uint32_t *stamp; /* by coarse node: the round in which it was numbered */
    uint32_t round;  /* one for each visit of a chunk */
    uint32_t count;  /* numbers given in this round, 0 included */
    uint32_t most;   /* largest count of any chunk; 0: the matrix is made from an assembled one */
    /* by node of the next level: a row of a level's matrix times its transfer */
    float (*half)[9];
} gxsp_pairs;

/* Cholesky factor of the last level, row by row within its envelope */
typedef struct gxsp_factor {
    uint32_t n;      /* unknowns */
    uint32_t *order; /* n / 3: node of the level in each place */
    uint32_t *first; /* n / 3: first column of the rows of each place */
    size_t *row;     /* n / 3: index in entry of column 0 of a place's first row, see gxsp_factor_row */
    float *entry;    /* entry_count; diagonal inverted */
    size_t entry_count;
    double *x;    /* n: solution */
    double *rows; /* 3 x n: the three rows at work; in shared memory */
} gxsp_factor;

typedef struct gxsp_material {
    gxs_material_kind kind;
    double mu, lambda; /* Pa; GXS_CUSTOM: a factor of its energy, and about its stiffness */
    double damping;    /* s */
    gxs_energy_fn energy;
    void *user;
} gxsp_material;

/* Copies joined by elements and constraints. E is a sum over components, but for springs and contact points that
 * join some. The first of those so joined leads the others; its energies and step length are those of all that it
 * leads. */
typedef struct gxsp_component {
    double sum[3];      /* over its copies, in the pass at work */
    double mass;        /* kg */
    double energies[3]; /* at the last evaluation: elastic with springs and contact, kinetic, size of their terms; J */
    double before[3];   /* at current */
    double base_energy; /* elastic energy of the state that the last step returned, J; valid while base_known */
    /* E at the step's start, which the step must not exceed, and E where Newton's method has ended; J */
    double limit, ended;
    /* midpoint rule: E at base; E at the middle without drift and E at a trial, both minus base; J */
    double base, low, gain;
    double reach;          /* quick steps by the midpoint rule: the share of the second half that the end is at */
    double elastic, slack; /* quick steps: elastic energy at the end of the last one, and what E is below its limit; J
                            */
    double drift[3];       /* midpoint rule: translation of the second half, which is not shortened, m */
    double slope, work;    /* dE/dlength of the direction, and the load's work along it; J */
    double left;           /* work of the linear solve's remaining residual along the direction; J */
    double rounding;    /* size of the rounding of positions and of the load's terms, in units in the last place; J */
    double length;      /* step length, as a share of the direction */
    uint32_t movers;    /* copies that neither are fixed nor follow others */
    int settled;        /* its length is found. A chunk whose components are all settled is not evaluated again */
    int risen;          /* E has ended above limit */
    uint32_t lead;      /* index of the component that leads it; its own index: it leads */
    uint64_t forces[2]; /* hash of its nodal forces and contact points: of the step before, of this one */
    int has_spring[2];  /* a spring acts on it: in the step before, in this one */
    int has_pair[2];    /* a pair joins it to something: in the step before, in this one */
    int paired;         /* pairs act on it at this linearisation */
    int outside;        /* springs or contact points act on it at this linearisation, not pairs alone */
    double island; /* kg: components under pairs alone that it leads; below 0: something else acts on one of them */
    int woken, resting; /* woken: something touches it in this step. resting: nothing does, and it has been slow for
                           long */
    uint32_t state;     /* GXSP_HELD ... GXSP_TOUCHES. 0: loose, so that a translation of it meets no stiffness */
} gxsp_component;

/* A copy, or a hidden vector of one, that follows others. The first four masters are the constraint's, or hidden
 * vectors of these; behind them, where an affine copy follows affine ones, the hidden vectors of these. */
typedef struct gxsp_follower {
    uint32_t copy, count, master[16];
    double weight[16];
} gxsp_follower;

/* A copy with next to none of the mass around it, such as the far corner of an element's thin rest after a cut; and
 * the lane of the element whose other corners guide it */
typedef struct gxsp_light {
    uint32_t copy, chunk;
    uint16_t lane, corner;
} gxsp_light;

/* A copy's share in a point */
typedef struct gxsp_share {
    uint32_t copy;
    float weight;
} gxsp_share;

/* Hessian of the springs and contact at one point, times scale */
typedef struct gxsp_term {
    size_t first; /* of gxsp_lasting.share */
    uint32_t count;
    int assembled; /* the assembled matrix has it */
    float hessian[6];
    float spread; /* of a pair: sum of its weights' sizes; 0: not a pair */
} gxsp_term;

/* How the body moves, for steps by quality: sums over steps, older ones by less */
typedef struct gxsp_tempo {
    double work;       /* of the change of elastic forces on a way, over the square of its time, J/s2 */
    double motion;     /* the square of the way's mean velocity, by mass, J */
    double weight;     /* of how many ways that is the sum */
    double resist[2];  /* likewise, of the stiffness of the explicit filter; motion on those ways */
    double stored;     /* elastic energy at the last measure, J */
    uint32_t measures; /* since the solver was made or resumed */
    uint32_t steps;    /* since the last measure */
    uint32_t refused;  /* explicit steps that were refused; those to come have shorter filters */
    uint32_t waiting;  /* steps that are implicit because of that */
    uint32_t age;      /* steps of this model: the first after a change is not worth what explicit steps need of it */
    int leaps;         /* the last step could be explicit */
    int hidden;        /* most kinetic energy is in vibrations that the last way averaged out */
    double pace;       /* s for an evaluation of explicit forces; 0: not known */
    double before_dt;  /* s, of the last part, by BDF2; 0: it was another one, or the model has changed */
    uint64_t end;      /* hash of the displacement at its end */
} gxsp_tempo;

/* What friction of a pair needs of the step's start */
typedef struct gxsp_grip {
    double load;      /* at most this force, N */
    double reach;     /* slip from which on it is, m */
    double before[3]; /* m: relative position */
    int sticks;       /* it did not slide at the end of the last step */
} gxsp_grip;

/* What the solver keeps from model to model */
typedef struct gxsp_lasting {
    gxsp_pool pool;    /* of term, share and parts */
    gxsp_term *term;   /* of the present linearisation */
    gxsp_share *share; /* of all terms, one after the other */
    size_t count, room, share_count, share_room;
    gxsp_grip *grip; /* grip_room: of each pair of the present step */
    size_t grip_room;
    double *parts; /* part_room: what steps by quality keep of the start, see gxsp_parts */
    size_t part_room;
    gxsp_tempo tempo;
    gxs_scene scene; /* of the step before */
} gxsp_lasting;

/* The model, in the solver's own order. Written when a model is set and by updates; steps only read it, except for the
 * step fields of the components. n: copies. */
typedef struct gxsp_model {
    size_t n;         /* gxs_model.copy_count */
    size_t copy_room; /* copies for which the columns over copies have room */
    size_t element_count;
    size_t range_count; /* n / GXSP_RANGE, rounded up */
    uint64_t epoch;     /* names the numbering of copies */
    double scale; /* power of two that multiplies the linear systems: single precision then holds tiny components */
    int lumped_mass;
    int stiff; /* a material is nearly incompressible */
    int damps; /* a material is damped */
    uint32_t material_count;
    gxsp_material *materials; /* material_count: as given */
    double *positions;        /* n x 3: rest positions, m; NULL: not given */
    double *lumped;           /* n: row sums of the mass, kg */
    uint8_t *held;            /* n: as given */
    uint8_t *fixed;           /* n: held, or neither supported by an element nor a follower */
    uint32_t *component;      /* n: index of the copy's component */
    gxsp_component *components;
    uint32_t component_count;
    gxsp_follower *followers;
    uint32_t follower_count, follower_room;
    /* n: index of the copy's entry in followers; GXSP_NONE: it follows none. Valid while there are followers */
    uint32_t *follower;
    gxsp_light *lights;
    uint32_t light_count, light_room;
    float *volume; /* n: inverse volume of the support, scaled; GXS_VOLUME_RATIO only, else NULL */
} gxsp_model;

/* The elements in chunks, and the slots into which chunks write. Written when a model is set and by updates. */
typedef struct gxsp_mesh {
    gxsp_chunk *chunks;
    uint32_t chunk_count, chunk_room;
    size_t block_count; /* of all chunks; not kept up to date by updates */
    size_t slot_count;  /* nodes of all chunks: one slot each */
    size_t slot_room;
    uint32_t *nodes;      /* slot_count: the copy of the slot; then GXSP_AHEAD zeros */
    uint32_t *copy_start; /* n + 1: a copy's range in copy_slot */
    /* slot_count: a copy's slots in the order of chunks, so that sums do not depend on threads; then GXSP_AHEAD zeros
     */
    uint32_t *copy_slot;
    /* slot_count: the least node of the chunk that the chunk's elements connect with this one. Valid while roots_known
     */
    uint16_t *slot_root;
    int roots_known;        /* set by the first update */
    gxsp_partial *partials; /* partial_count: those of the first chunk, then of the next */
    uint32_t partial_count;
} gxsp_mesh;

/* Structure of the multigrid, and the numbers of its matrices. Everything below level 0 is in its own pool, which is
 * replaced with the levels. The first solve that uses levels makes them, or brings them up to date: see
 * gxsp_fit_levels. */
typedef struct gxsp_multigrid {
    gxsp_pool pool;
    gxsp_level levels[GXSP_LEVELS]; /* level 0 is the model */
    uint32_t level_count;           /* 0: there are no levels, or none yet */
    double spacing;                 /* of level 1's lattice, m; 0: there can be no levels */
    uint8_t *dirty;   /* by node of level 1: some of its followers have been touched since the levels were made */
    gxsp_owned *mark; /* what pool has from here on depends on the pattern of level 1 */
    int fits;         /* the model has not been updated since the levels were made */
    /* Level 1 has entries between the sides of those pairs: see gxsp_hash_sides; 0: it has none; 1: of others */
    uint64_t joined;
    int chosen;       /* the preconditioner was chosen by the size of components */
    int used;         /* the levels precondition the solve at work */
    gxsp_fine *fine;  /* block_count: entries of the assembled matrix, levels[0]; NULL: matrix-free */
    gxsp_edges edges; /* of the chunk at work; its arrays are in scratch or shared memory */
    gxsp_pairs pairs; /* of the chunk at work; its arrays are in scratch or shared memory */
    gxsp_factor factor;
} gxsp_multigrid;

/* At which state the coarse matrices were made, and how they age. A reading measures the pace of conjugate gradients.
 */
typedef struct gxsp_coarse {
    double rate;          /* of the inertia in the matrices; below 0: they were never made */
    double *displacement; /* n x 3: at which they were made; of a multigrid only */
    double stiffness;     /* sum of springs' and contact's Hessians in them */
    int quick;            /* they were made by a quick step, so with lumped mass */
    int worn;             /* they must be made anew */
    uint32_t served;      /* iterations since they were made */
    uint32_t life;        /* iterations that they are to serve */
    uint32_t lived;       /* iterations that those before served */
    uint32_t read;        /* iterations since the last reading */
    double read_nepers;   /* factors of e by which those iterations reduced residuals */
    double pace;          /* iterations for each factor of e, by the last reading; 0: none yet */
    double pace_young;    /* by the first reading */
    double pace_old;      /* by the last reading of the matrices before; 0: none, or of another time step */
} gxsp_coarse;

/* The step length of the smoother on level 0. */
typedef struct gxsp_smoother {
    float omega;            /* step length in use; 0: not known */
    float found;            /* by the largest eigenvalue found, which may have grown since */
    uint32_t cautious;      /* linear solves during which omega stays the safe length; 0: omega is the one found */
    uint32_t next_cautious; /* cautious, the next time that omega proves too large */
    uint8_t *renewed;       /* n: the copy's elements are not those for which omega was found. Valid if any_renewed */
    int any_renewed;
} gxsp_smoother;

/* The vectors of a step, n x 3 unless said, and the memory that passes and coarse numbers share. */
typedef struct gxsp_vectors {
    double *target;    /* where inertia and mass damping alone lead, m; backward Euler: u_n + dt v_n */
    double *damping;   /* what Rayleigh damping adds to the load, N; NULL: no material is damped */
    double *current;   /* Newton's iterate, m */
    double *force;     /* inertia + elastic at the iterate, N */
    double *residual;  /* load - force, N; conjugate gradients use it up, then gxsp_trial has its memory */
    double *direction; /* solution of the linear system, m */
    float *diagonal;   /* n x 6: inverse of the Hessian's diagonal blocks, packed; 0 for fixed copies */
    /* n: directions of the first iterations of the last step and of the one before; see gxsp_state.guess_count */
    gxsp_vector4 *guess[2];
    gxsp_vector4 *right;            /* n: residual in single precision; GXS_MATRIX_ASSEMBLED only, else NULL */
    double (*range_sum)[GXSP_SUMS]; /* range_count: sums of a pass over copies; added up in their order */
    /* shared_room bytes. Passes have slots, search, product and scaled in it. Between gxsp_lend_memory and
     * gxsp_return_memory the making of coarse numbers has its arrays there: see gxsp_numbers_carve */
    unsigned char *shared;
    size_t shared_room;
    double (*slots)[3];                      /* slot_count: a chunk's result for each node: 3 doubles, 4 or 6 floats */
    gxsp_vector4 *search, *product, *scaled; /* n: CG's direction, Hessian times it, preconditioned residual */
} gxsp_vectors;

/* What one step leaves to the next, and what the step under way leaves alone. */
typedef struct gxsp_history {
    gxsp_material *damped;    /* material_count: the step's materials, stiffer by Rayleigh damping */
    uint8_t *still;           /* n: fixed or asleep: the step leaves the copy alone */
    uint8_t *chunk_still;     /* chunk_count: all copies of the chunk are still */
    int still_known;          /* still and chunk_still agree with the states of the components */
    uint8_t *chunk_collapsed; /* chunk_count: the last linearisation found an element collapsed to a point */
    uint32_t loose_count;     /* components of state 0 */
    uint32_t free_count;      /* components of no state but GXSP_TOUCHED */
    double term_stiffness;    /* sum of springs' and contact's Hessians */
    size_t active;            /* unknowns of this step */
    int stepped;    /* current is what the last step returned; copies that a cut has made are at their origin's place */
    int base_known; /* current is what the last step returned, and components know its elastic energies */
    int failed;     /* the last step failed: the components that it woke stay awake */
    int quick;      /* the step is quick: products are those of the strains, mass is lumped */
    double product_rate;  /* of the linearisation for gxs_solver_product; below 0: there is none */
    uint32_t guess_count; /* valid guesses: 0, 1 or 2 */
} gxsp_history;

/* Eight elements with affine copies, see >>rule. A lane without an element has no weight and no vectors. */
typedef struct gxsp_affine_block {
    gxsp_rest rest;                  /* weight and mass of one of the four points: a quarter of the element's */
    gxsp_lanes gradient[9];          /* of shape functions 1 ... 3, by rows, 1/m */
    gxsp_lanes edge[9];              /* (X_j - X_0) / (4 length), j = 1 ... 3 */
    gxsp_lanes shape[4][4];          /* N_i at point p: [p][i] */
    gxsp_lanes energies[3];          /* of the last pass, as in gxsp_partial */
    gxsp_tangent tangent[4];         /* at each point; its mass is 0 */
    gxsp_general *general;           /* 4; GXS_CUSTOM only, else NULL */
    uint32_t vector[16][GXSP_LANES]; /* copies of the corners; at 4 + 3 i the hidden vectors of corner i, or GXSP_NONE
                                      */
    gxs_material_kind kind;
    uint8_t still, collapsed; /* all its vectors are still; the last linearisation found an element collapsed */
} gxsp_affine_block;

/* Affine copies: what their elements and the multigrid need beside chunks and levels. All 0 where no copy is affine. A
 * group is an affine copy with its three hidden vectors: parts 0 ... 3. */
typedef struct gxsp_affine {
    size_t count;  /* elements; 0: there are none */
    double length; /* m: hidden vectors are columns of A times this */
    gxsp_affine_block *blocks;
    uint32_t *groups; /* block_count x GXSP_LANES: gxs_element.group; GXSP_NONE: the lane has no element */
    uint32_t block_count, block_room, group_count, group_room;
    uint32_t round;        /* first block of the round under way: see GXSP_AFFINE_ROUND */
    uint32_t slot_blocks;  /* blocks for which slots have room */
    uint32_t *place;       /* n: 4 x group + part; GXSP_NONE: a copy that is not affine. NULL: there are no groups */
    uint32_t (*member)[4]; /* group_count: vectors of a group */
    double (*slots)[3];    /* blocks of a round x 16 x GXSP_LANES: their results */
    double (*sum)[3];      /* n: results of a product */
    double (*own)[6];      /* n: diagonal blocks of the elements here, packed, scaled */
    double (*full)[10][9]; /* group_count: blocks of the parts p <= q, in the order of gxs_element.mass, by rows */
    float (*root)[78];     /* group_count: W by rows, lower triangle: the inverse of the 12x12 block is W^T W */
    uint32_t *hidden; /* by node of level 1: the first of its three hidden nodes, or GXSP_NONE. NULL: no multigrid */
    uint32_t hidden_count; /* nodes that hidden has */
    float (*offset)[4][3]; /* group_count: (X_i - X_J) / length for each parent J */
    double origin[3];      /* of level 1's lattice, m */
    float stretch;         /* by which it was widened */
    double *block;         /* 9 per entry of level 1: what the elements here add */
    double *entry;         /* factor of level 1, rows as in gxsp_factor */
} gxsp_affine;

/* A block's elements in explicit steps. A lane without an element has zeros. */
typedef struct gxsp_leap_block {
    float gradient[9][GXSP_LANES];            /* of shape functions 1 ... 3, by rows, 1/m */
    float mu[GXSP_LANES], lambda[GXSP_LANES]; /* weight x moduli, J */
} gxsp_leap_block;

/* What products need of a block's elements at a displacement, see >>strains. A lane without an element has zeros. */
typedef struct gxsp_strain {
    float gradient[9][GXSP_LANES]; /* of the displacement, by rows */
    /* factors of D, of F : D, of cof F : D and of dcof F in the change of stress, times weight and scale */
    float own[GXSP_LANES], along[GXSP_LANES], sides[GXSP_LANES], turn[GXSP_LANES];
} gxsp_strain;

/* What explicit and quick steps need of the model, made by the first one; and their vectors. All arrays are in its own
 * pool. */
typedef struct gxsp_leap {
    gxsp_pool pool;
    /* for the present model: GXSP_LEAP_BLOCKS: what quick steps need; GXSP_LEAP_ALL: what explicit ones need, too */
    int made;
    int suits;               /* materials and copies allow such steps. Else nothing below is there */
    gxsp_leap_block *blocks; /* block_count: those of the first chunk, then of the next */
    size_t block_count;
    uint32_t *first_block; /* chunk_count: of each chunk */
    gxsp_strain *strains;  /* block_count: of the last quick step; NULL before the first */
    /* L, which bounds the stiffness: one number for a pair of copies, by groups of rows. order: n: copies of the rows.
     * start: n / GXSP_LEAP_ROWS, rounded up, + 1; entry k of the group's row r is at GXSP_LEAP_ROWS (start + k) + r */
    uint32_t *order, *start, *column;
    float *entry;    /* N/m */
    float *diagonal; /* n: N/m */
    float *mass;     /* n: lumped, and more where copies are light, kg; 0: it is fixed */
    float *inverse;  /* n: 1/mass, 0 where the step leaves the copy alone */
    float *stiffest; /* chunk_count: largest modulus at the last forces, relative to that at rest */
    /* n: accelerations; the last three of Chebyshev's recurrence, m/s2 */
    gxsp_vector4 *start_of_filter, *last, *before, *next;
    double top;    /* largest eigenvalue of M^-1 L, 1/s2 */
    double factor; /* on L; 0: the first */
    double limit;  /* of energy, J. Valid if limited */
    int limited;   /* the last step was explicit */
    /* quick steps since Hessian and diagonal were made; 0: they must be. The last one was quick: components have their
     * slack */
    uint32_t served;
    int known;
} gxsp_leap;

/* A model in the solver's form, and all that its steps work with. One allocation of pool, as are its arrays. */
typedef struct gxsp_system {
    gxsp_pool pool;
    const gx_jobs *jobs;   /* of the solver */
    gxsp_lasting *lasting; /* of the solver */
    gxsp_model model;
    gxsp_mesh mesh;
    gxsp_affine affine;
    gxsp_multigrid multigrid;
    gxsp_coarse coarse;
    gxsp_smoother smoother;
    gxsp_vectors vectors;
    gxsp_history state;
    gxsp_leap leap;
} gxsp_system;

/* The line search's trial displacement, n x 3. It lies in the residual's memory: nothing needs the residual while
 * lengths are tried. */
static double *gxsp_trial(const gxsp_system *system) { return system->vectors.residual; }

/* A step under way */
typedef struct gxsp_problem {
    gxsp_system *system;
    const gxs_step_desc *step;
    double rate;            /* factor of inertia, rate/2 |u - target|_M^2; 1/s2 */
    double speed;           /* v = speed (u - a mean of the displacements before), 1/s */
    double mean[2];         /* weights of given and of previous_displacement in that mean */
    uint32_t cg_iterations; /* with defaults filled in */
    double cg_tolerance;
    /* factors of e by which the last linear solve reduced the residual left by its guess */
    double nepers;
    double energies[3];  /* at current, sums over components; J */
    const double *given; /* the caller's displacement at the step's start, u_n */
    double start;        /* on the clock */
    gxs_scene scene;
    double moved;       /* share of affine copies' motion in this step that the last iteration has made */
    int exact;          /* the linearisation is not projected */
    int indefinite;     /* conjugate gradients met negative curvature */
    int projected_only; /* the exact linearisation has proved indefinite in this step */
    uint32_t added;     /* Newton iterations beside those of the step's description */
    int shortened;      /* the line search did not take the whole step */
    int damps;          /* damping adds to the load */
    int stalls;         /* consecutive iterations that noise ended and that gained next to nothing */
    double least;       /* smallest residual so far */
    int based;          /* components know E at base */
    int noise;          /* at the end of the line search energies differed by rounding only */
    int starved;        /* there was no memory for coarse levels */
    int collapsed;      /* the linearisation found elements collapsed to a point */
    gxs_step_report report;
} gxsp_problem;

/* In- and output of a pass. Unused fields are 0. Vectors have one entry per copy. */
typedef struct gxsp_pass {
    gxsp_system *system;
    double rate;        /* 1/s2; in products and linearisations times scale */
    const double *from; /* x 3: displacement, m */
    double *sum;        /* x 3: forces, N */
    const gxsp_material *materials;
    const double *rotated; /* x 3: stresses are rotated with the elements' motion from `from` to this displacement;
                              NULL: they are not */
    int inertia;           /* with forces and energy of inertia */
    int nudge;             /* collapsed elements get the forces of nearly collapsed ones */
    int exact;             /* Hessians are not projected */
    gxsp_vector4 *x;       /* of products: input */
    gxsp_vector4 *y;       /* output */
    const double *right;   /* x 3: output is this minus the product; NULL: it is the product */
    double factor;         /* in passes over copies: multiplies x */
    const gxsp_problem *problem; /* for passes that need the load */
} gxsp_pass;

struct gxs_solver {
    gx_allocator allocator;
    gx_jobs jobs;
    gxs_preconditioner preconditioner;
    gxs_matrix matrix;
    gxsp_lasting lasting;
    gxsp_system *system; /* in its own pool; NULL before the first model */
};

/* >>columns: arrays that have one entry for each copy, slot or chunk ----------------------------------------------- */

/* The tables list them once. Making, growth and updates go by the tables, and touch no other array but the sums
 * of ranges. A column that a model does not need is NULL and stays so. */

/* When a column is made: by the code that needs it, with the model, or last, for steps */
enum { GXSP_BY_OWNER, GXSP_WITH_MODEL, GXSP_FOR_STEPS };

typedef struct gxsp_column {
    size_t offset; /* of the array's pointer, in gxsp_system */
    size_t size;   /* bytes of an entry */
    size_t extra;  /* entries behind the last */
    int made;      /* GXSP_BY_OWNER ... GXSP_FOR_STEPS */
    int kept;      /* growth keeps the entries, and updates move them with their copies; else they are made anew */
} gxsp_column;

#define GXSP_IN(field) offsetof(gxsp_system, field)

/* clang-format off */
static const gxsp_column gxsp_copy_columns[] = {
    /* array                                                     bytes                 extra       made          kept */
    {GXSP_IN(model.positions),                                  3 * sizeof(double),   0,          GXSP_BY_OWNER,   1},
    {GXSP_IN(model.lumped),                                     sizeof(double),       0,          GXSP_WITH_MODEL, 1},
    {GXSP_IN(model.component),                                  sizeof(uint32_t),     0,          GXSP_WITH_MODEL, 1},
    {GXSP_IN(model.fixed),                                      1,                    0,          GXSP_WITH_MODEL, 1},
    {GXSP_IN(model.held),                                       1,                    0,          GXSP_WITH_MODEL, 1},
    {GXSP_IN(model.follower),                                   sizeof(uint32_t),     0,          GXSP_BY_OWNER,   0},
    {GXSP_IN(mesh.copy_start),                                  sizeof(uint32_t),     2,          GXSP_WITH_MODEL, 0},
    {GXSP_IN(state.still),                                      1,                    0,          GXSP_WITH_MODEL, 0},
    {GXSP_IN(vectors.target),                                   3 * sizeof(double),   0,          GXSP_FOR_STEPS,  0},
    {GXSP_IN(vectors.damping),                                  3 * sizeof(double),   0,          GXSP_BY_OWNER,   0},
    {GXSP_IN(vectors.current),                                  3 * sizeof(double),   0,          GXSP_FOR_STEPS,  1},
    {GXSP_IN(vectors.force),                                    3 * sizeof(double),   0,          GXSP_FOR_STEPS,  0},
    {GXSP_IN(vectors.residual),                                 3 * sizeof(double),   0,          GXSP_FOR_STEPS,  0},
    {GXSP_IN(vectors.direction),                                3 * sizeof(double),   0,          GXSP_FOR_STEPS,  0},
    {GXSP_IN(vectors.diagonal),                                 6 * sizeof(float),    0,          GXSP_FOR_STEPS,  0},
    {GXSP_IN(vectors.guess),                                    sizeof(gxsp_vector4), 0,          GXSP_FOR_STEPS,  1},
    {GXSP_IN(vectors.guess) + sizeof(gxsp_vector4 *),           sizeof(gxsp_vector4), 0,          GXSP_FOR_STEPS,  1},
    {GXSP_IN(vectors.right),                                    sizeof(gxsp_vector4), 0,          GXSP_BY_OWNER,   0},
    {GXSP_IN(smoother.renewed),                                 1,                    0,          GXSP_FOR_STEPS,  0},
    {GXSP_IN(coarse.displacement),                              3 * sizeof(double),   0,          GXSP_BY_OWNER,   1},
    {GXSP_IN(affine.place),                                     sizeof(uint32_t),     0,          GXSP_BY_OWNER,   0},
    {GXSP_IN(affine.sum),                                       3 * sizeof(double),   0,          GXSP_BY_OWNER,   0},
    {GXSP_IN(affine.own),                                       6 * sizeof(double),   0,          GXSP_BY_OWNER,   0},
    {GXSP_IN(multigrid.levels) + offsetof(gxsp_level, parent),  4 * sizeof(uint32_t), 0,          GXSP_BY_OWNER,   1},
    {GXSP_IN(multigrid.levels) + offsetof(gxsp_level, weight),  4 * sizeof(float),    0,          GXSP_BY_OWNER,   1}};

static const gxsp_column gxsp_slot_columns[] = {
    {GXSP_IN(mesh.nodes),                                       sizeof(uint32_t),     GXSP_AHEAD, GXSP_BY_OWNER,   0},
    {GXSP_IN(mesh.copy_slot),                                   sizeof(uint32_t),     GXSP_AHEAD, GXSP_BY_OWNER,   0},
    {GXSP_IN(mesh.slot_root),                                   sizeof(uint16_t),     0,          GXSP_BY_OWNER,   0}};

static const gxsp_column gxsp_chunk_columns[] = {
    {GXSP_IN(mesh.chunks),                                      sizeof(gxsp_chunk),   0,          GXSP_WITH_MODEL, 1},
    {GXSP_IN(state.chunk_collapsed),                            1,                    0,          GXSP_WITH_MODEL, 0},
    {GXSP_IN(state.chunk_still),                                1,                    0,          GXSP_WITH_MODEL, 0}};
/* clang-format on */

/* The columns of a table and how many there are */
#define GXSP_COLUMNS(table) table, sizeof(table) / sizeof *(table)

static void *gxsp_column_array(const gxsp_system *system, const gxsp_column *column) {
    void *array;
    memcpy(&array, (const unsigned char *)system + column->offset, sizeof array);
    return array;
}

static void gxsp_set_column(gxsp_system *system, const gxsp_column *column, void *array) {
    memcpy((unsigned char *)system + column->offset, &array, sizeof array);
}

/* Makes the columns of a stage, with room for so many entries; all entries are 0. */
static void gxsp_columns_make(gxsp_system *system, const gxsp_column *columns, size_t count, int made, size_t room) {
    size_t i;
    for (i = 0; i < count; i++)
        if (columns[i].made == made)
            gxsp_set_column(system, &columns[i], gxsp_take(&system->pool, room + columns[i].extra, columns[i].size));
}

/* Gives the columns that there are room for so many entries. used: entries of those that are kept */
static void gxsp_columns_grow(gxsp_system *system, const gxsp_column *columns, size_t count, size_t used, size_t room) {
    size_t i;
    for (i = 0; i < count; i++) {
        void *array = gxsp_column_array(system, &columns[i]);
        if (array)
            gxsp_set_column(
                system, &columns[i],
                gxsp_grow(&system->pool, array, columns[i].kept ? used : 0, room + columns[i].extra, columns[i].size));
    }
}

/* Room for so many copies. The columns that are kept keep the entries of the copies so far. */
static void gxsp_copies_room(gxsp_system *system, size_t count) {
    const size_t room = gxsp_room(count);
    if (count <= system->model.copy_room) return;
    gxsp_columns_grow(system, GXSP_COLUMNS(gxsp_copy_columns), system->model.n, room);
    system->vectors.range_sum = (double(*)[GXSP_SUMS])gxsp_grow(
        &system->pool, system->vectors.range_sum, 0, room / GXSP_RANGE + 1, sizeof *system->vectors.range_sum);
    system->model.copy_room = room;
}

/* Room for so many slots, and roots of them. What they held is lost. */
static void gxsp_slots_room(gxsp_system *system, size_t count) {
    if (count > system->mesh.slot_room) {
        system->mesh.slot_room = gxsp_room(count);
        gxsp_columns_grow(system, GXSP_COLUMNS(gxsp_slot_columns), 0, system->mesh.slot_room);
    }
    if (!system->mesh.slot_root)
        system->mesh.slot_root = (uint16_t *)gxsp_take(&system->pool, system->mesh.slot_room, sizeof(uint16_t));
    system->mesh.slot_count = count;
}

/* Room for one more chunk */
static void gxsp_chunk_room(gxsp_system *system) {
    const uint32_t count = system->mesh.chunk_count;
    if (count < system->mesh.chunk_room) return;
    system->mesh.chunk_room = (uint32_t)gxsp_room(count) + 8;
    gxsp_columns_grow(system, GXSP_COLUMNS(gxsp_chunk_columns), count, system->mesh.chunk_room);
}

/* Moves the entries of the kept columns with their copies. moved: moved_count copies that are not where their origins
 * (as of gxs_change) were; saved: room for as many entries of the largest kind, 3 doubles */
static void gxsp_columns_move(gxsp_system *system, const uint32_t *origins, const uint32_t *moved, size_t moved_count,
                              unsigned char *saved) {
    size_t c, i;
    for (c = 0; c < sizeof gxsp_copy_columns / sizeof *gxsp_copy_columns; c++) {
        const size_t size = gxsp_copy_columns[c].size;
        unsigned char *array = (unsigned char *)gxsp_column_array(system, &gxsp_copy_columns[c]);
        if (!array || !gxsp_copy_columns[c].kept) continue;
        for (i = 0; i < moved_count; i++) memcpy(saved + i * size, array + (origins[moved[i]] >> 1) * size, size);
        for (i = 0; i < moved_count; i++) memcpy(array + moved[i] * size, saved + i * size, size);
    }
}

/* >>jobs: loops, by threads or not --------------------------------------------------------------------------------- */

/* In: a task and how often to call it. A task writes its own chunk, slots, range or sums only; sums of ranges are
 * added up in their order, so that results do not depend on threads. */

/* Calls task(context, i) for every i below count, by the host's threads if there are any. */
static void gxsp_parallel(const gx_jobs *jobs, size_t count, void (*task)(void *, size_t), void *context) {
    size_t i;
    if (jobs->parallel_for && count > 1)
        jobs->parallel_for(jobs->user, count, task, context);
    else
        for (i = 0; i < count; i++) task(context, i);
}

/* The first copy of a range, and one past its last, which is returned */
static size_t gxsp_range(const gxsp_system *system, size_t index, size_t *first) {
    *first = index * GXSP_RANGE;
    return *first + GXSP_RANGE < system->model.n ? *first + GXSP_RANGE : system->model.n;
}

/* A pass over all copies. sums: the first count of the sums that it makes for each range, or NULL */
static void gxsp_over_ranges(gxsp_system *system, void (*task)(void *, size_t), gxsp_pass *pass, double *sums,
                             int count) {
    size_t i;
    int k;
    pass->system = system;
    gxsp_parallel(system->jobs, system->model.range_count, task, pass);
    for (k = 0; k < count; k++)
        for (i = 0, sums[k] = 0; i < system->model.range_count; i++) sums[k] += system->vectors.range_sum[i][k];
}

/* Prefetches memory that is read soon. A block is too long for processors to prefetch the next one in time. Always
 * inline: gcc takes a function that only prefetches for one without effect, and drops its calls. */
GXSP_INLINE void gxsp_prefetch(const void *memory, size_t size) {
#if defined(__GNUC__) || defined(__clang__)
    const char *line = (const char *)memory;
    size_t k;
    for (k = 0; k < size; k += 64) __builtin_prefetch(line + k);
#elif defined(GXFEM_INTRINSICS) && defined(_M_X64)
    const char *line = (const char *)memory;
    size_t k;
    for (k = 0; k < size; k += 64) _mm_prefetch(line + k, _MM_HINT_T0);
#else
    (void)memory;
    (void)size;
#endif
}

/* >>svd: stretches and rotations of F ------------------------------------------------------------------------------ */

/* In: displacement gradients of one or two blocks. Out: F = U diag(s) V^T in single precision; a rotation can be
 * polished to double precision. */

typedef struct gxsp_svd {
    gxsp_singles u[9], v[9]; /* rotations, determinant 1 */
    gxsp_singles s[3];       /* signed, in order of size; F = U diag(s) V^T */
} gxsp_svd;

/* F V and V of two blocks, on the way to an SVD. Each rotation waits for the one before it, so that the second
 * block costs little. */
typedef struct gxsp_jacobi {
    float b[9][2 * GXSP_LANES], v[9][2 * GXSP_LANES];
    float scale[2 * GXSP_LANES]; /* multiplies b */
} gxsp_jacobi;

/* Rotates (x, y) by the angle of cosine c and sine s. */
static inline void gxsp_turn(float c, float s, float *x, float *y) {
    const float rotated = c * *x - s * *y;
    *y = s * *x + c * *y;
    *x = rotated;
}

/* Rotates columns i and j of b and of v in lane l. */
static inline void gxsp_turn_columns(gxsp_jacobi *jacobi, int i, int j, int l, float c, float s) {
    gxsp_turn(c, s, &jacobi->b[i][l], &jacobi->b[j][l]);
    gxsp_turn(c, s, &jacobi->b[3 + i][l], &jacobi->b[3 + j][l]);
    gxsp_turn(c, s, &jacobi->b[6 + i][l], &jacobi->b[6 + j][l]);
    gxsp_turn(c, s, &jacobi->v[i][l], &jacobi->v[j][l]);
    gxsp_turn(c, s, &jacobi->v[3 + i][l], &jacobi->v[3 + j][l]);
    gxsp_turn(c, s, &jacobi->v[6 + i][l], &jacobi->v[6 + j][l]);
}

static inline float gxsp_jacobi_product(const gxsp_jacobi *jacobi, int i, int j, int l) {
    return jacobi->b[i][l] * jacobi->b[j][l] + jacobi->b[3 + i][l] * jacobi->b[3 + j][l] +
           jacobi->b[6 + i][l] * jacobi->b[6 + j][l];
}

/* Makes columns i and j of b orthogonal. U and V stay rotations whatever the rounding: a Hessian built on them is a
 * congruence of a semi-definite one. */
GXSP_INLINE void gxsp_orthogonalise(gxsp_jacobi *GXSP_RESTRICT jacobi, int i, int j) {
    int l;
    GXSP_EACH_OF_TWO(l) {
        const float gamma = 2 * gxsp_jacobi_product(jacobi, i, j, l);
        const float gap = gxsp_jacobi_product(jacobi, j, j, l) - gxsp_jacobi_product(jacobi, i, i, l);
        const float size = gap < 0 ? -gap : gap, square = gap * gap + gamma * gamma + 1e-35f;
        const float tangent = (gap < 0 ? -gamma : gamma) / (size + square * gxsp_rsqrt(square));
        const float c = gxsp_rsqrt(1 + tangent * tangent);
        gxsp_turn_columns(jacobi, i, j, l, c, c * tangent);
    }
}

/* Makes column i the longer one of i and j, by a quarter turn, so that det V stays 1. */
GXSP_INLINE void gxsp_order_columns(gxsp_jacobi *GXSP_RESTRICT jacobi, int i, int j) {
    int l;
    GXSP_EACH_OF_TWO(l) {
        const float s = gxsp_jacobi_product(jacobi, j, j, l) > gxsp_jacobi_product(jacobi, i, i, l) ? -1.0f : 0.0f;
        gxsp_turn_columns(jacobi, i, j, l, 1 + s, s);
    }
}

/* U, V and s of the block that begins at first_lane, from the columns of b, which are orthogonal and sorted by
 * falling length. Where columns vanish, U is completed to a rotation. */
static void gxsp_frame(const gxsp_jacobi *GXSP_RESTRICT jacobi, int first_lane, gxsp_svd *GXSP_RESTRICT svd) {
    const float *scale = jacobi->scale + first_lane;
    int k, l;
    for (k = 0; k < 9; k++) memcpy(svd->v[k], jacobi->v[k] + first_lane, sizeof svd->v[k]);
    GXSP_EACH_LANE(l) {
        const int m = first_lane + l;
        const float a0 = jacobi->b[0][m], a1 = jacobi->b[3][m], a2 = jacobi->b[6][m], b0 = jacobi->b[1][m],
                    b1 = jacobi->b[4][m], b2 = jacobi->b[7][m];
        const float c0 = jacobi->b[2][m], c1 = jacobi->b[5][m], c2 = jacobi->b[8][m];
        const float first = a0 * a0 + a1 * a1 + a2 * a2, some = first > 1e-30f ? 1.0f : 0.0f;
        const float reach = gxsp_rsqrt(first + 1e-30f) * some;
        const float u0 = a0 * reach + (1 - some), u1 = a1 * reach, u2 = a2 * reach;
        const float along = u0 * b0 + u1 * b1 + u2 * b2;
        const float p0 = b0 - along * u0, p1 = b1 - along * u1, p2 = b2 - along * u2;
        /* where F maps to a line, any direction across it serves: that of the axis least along it is taken */
        const float s0 = u0 * u0, s1 = u1 * u1, s2 = u2 * u2;
        const float x = s0 <= s1 && s0 <= s2 ? 1.0f : 0.0f, y = (1 - x) * (s1 <= s2 ? 1.0f : 0.0f), z = 1 - x - y;
        const float part = x * u0 + y * u1 + z * u2;
        const float n0 = x - part * u0, n1 = y - part * u1, n2 = z - part * u2;
        const float across = p0 * p0 + p1 * p1 + p2 * p2, wide = across > 1e-12f * first + 1e-30f ? 1.0f : 0.0f,
                    thin = 1 - wide;
        const float q0 = wide * p0 + thin * n0, q1 = wide * p1 + thin * n1, q2 = wide * p2 + thin * n2;
        const float unit = gxsp_rsqrt(q0 * q0 + q1 * q1 + q2 * q2);
        const float w0 = q0 * unit, w1 = q1 * unit, w2 = q2 * unit;
        const float t0 = u1 * w2 - u2 * w1, t1 = u2 * w0 - u0 * w2, t2 = u0 * w1 - u1 * w0;
        svd->u[0][l] = u0, svd->u[3][l] = u1, svd->u[6][l] = u2;
        svd->u[1][l] = w0, svd->u[4][l] = w1, svd->u[7][l] = w2;
        svd->u[2][l] = t0, svd->u[5][l] = t1, svd->u[8][l] = t2;
        svd->s[0][l] = scale[l] * (u0 * a0 + u1 * a1 + u2 * a2);
        svd->s[1][l] = scale[l] * (w0 * b0 + w1 * b1 + w2 * b2);
        svd->s[2][l] = scale[l] * (t0 * c0 + t1 * c1 + t2 * c2);
    }
}

/* Are the columns of b orthogonal to single precision in every lane? The largest entry of b is 1. */
static int gxsp_orthogonal(const gxsp_jacobi *GXSP_RESTRICT jacobi) {
    float square[2 * GXSP_LANES], most = 0;
    int l;
    GXSP_EACH_OF_TWO(l) {
        const float x = gxsp_jacobi_product(jacobi, 0, 1, l), y = gxsp_jacobi_product(jacobi, 0, 2, l),
                    z = gxsp_jacobi_product(jacobi, 1, 2, l);
        square[l] = x * x + y * y + z * z;
    }
    for (l = 0; l < 2 * GXSP_LANES; l++) most = square[l] > most ? square[l] : most;
    return most < 1e-13f;
}

/* F = 1 + G of a block, divided by its largest entry, as columns at first_lane, and V = 1 */
static void gxsp_jacobi_begin(gxsp_lanes *GXSP_RESTRICT g, int first_lane, gxsp_jacobi *GXSP_RESTRICT jacobi) {
    int k, l;
    GXSP_EACH_LANE(l) {
        const int m = first_lane + l;
        const float f0 = (float)(g[0][l] + 1), f1 = (float)g[1][l], f2 = (float)g[2][l], f3 = (float)g[3][l],
                    f4 = (float)(g[4][l] + 1), f5 = (float)g[5][l], f6 = (float)g[6][l], f7 = (float)g[7][l],
                    f8 = (float)(g[8][l] + 1);
        const float a = gxsp_larger(gxsp_larger(f0, f1), gxsp_larger(f2, f3)),
                    b = gxsp_larger(gxsp_larger(f4, f5), gxsp_larger(f6, f7));
        const float largest = gxsp_larger(gxsp_larger(a, b), f8), scale = largest > 1e-30f ? largest : 1.0f,
                    inverse = 1 / scale;
        jacobi->scale[m] = scale;
        jacobi->b[0][m] = gxsp_clean(inverse * f0), jacobi->b[1][m] = gxsp_clean(inverse * f1),
        jacobi->b[2][m] = gxsp_clean(inverse * f2);
        jacobi->b[3][m] = gxsp_clean(inverse * f3), jacobi->b[4][m] = gxsp_clean(inverse * f4),
        jacobi->b[5][m] = gxsp_clean(inverse * f5);
        jacobi->b[6][m] = gxsp_clean(inverse * f6), jacobi->b[7][m] = gxsp_clean(inverse * f7),
        jacobi->b[8][m] = gxsp_clean(inverse * f8);
    }
    for (k = 0; k < 9; k++) GXSP_EACH_LANE(l) jacobi->v[k][first_lane + l] = k % 4 == 0 ? 1.0f : 0.0f;
}

/* F = 1 + G = U diag(s) V^T of two blocks, or of one if last is NULL, by one-sided Jacobi with the same number of
 * sweeps in every lane. svd: one entry per block. */
static void gxsp_decompose(gxsp_lanes *first, gxsp_lanes *last, gxsp_svd *svd) {
    gxsp_jacobi jacobi;
    int sweep;
    gxsp_jacobi_begin(first, 0, &jacobi);
    gxsp_jacobi_begin(last ? last : first, GXSP_LANES, &jacobi);
    /* convergence is quadratic: 4 sweeps reach single precision even for extreme F */
    for (sweep = 0; sweep < 4 && !gxsp_orthogonal(&jacobi); sweep++) {
        gxsp_orthogonalise(&jacobi, 0, 1);
        gxsp_orthogonalise(&jacobi, 0, 2);
        gxsp_orthogonalise(&jacobi, 1, 2);
    }
    gxsp_order_columns(&jacobi, 0, 1);
    gxsp_order_columns(&jacobi, 0, 2);
    gxsp_order_columns(&jacobi, 1, 2);
    gxsp_frame(&jacobi, 0, &svd[0]);
    if (last) gxsp_frame(&jacobi, GXSP_LANES, &svd[1]);
}

/* Cofactors of a 3x3: the derivative of its determinant */
static void gxsp_cofactors(const double *a, double *cofactors) {
    cofactors[0] = a[4] * a[8] - a[5] * a[7];
    cofactors[1] = a[5] * a[6] - a[3] * a[8];
    cofactors[2] = a[3] * a[7] - a[4] * a[6];
    cofactors[3] = a[2] * a[7] - a[1] * a[8];
    cofactors[4] = a[0] * a[8] - a[2] * a[6];
    cofactors[5] = a[1] * a[6] - a[0] * a[7];
    cofactors[6] = a[1] * a[5] - a[2] * a[4];
    cofactors[7] = a[2] * a[3] - a[0] * a[5];
    cofactors[8] = a[0] * a[4] - a[1] * a[3];
}

/* One step of Newton's method for the rotation R of F = R S: R (1 + skew omega) with (tr S - S) omega = axis of S's
 * skew part, then orthogonal again to second order. Does nothing where tr S - S is singular: R is not unique there. */
static void gxsp_polish_rotation(const double *f, double *rotation) {
    double s[9], a[9], inverse[9], axis[3], omega[3], rotated[9], square[9], determinant, trace;
    int r, c, k;
    for (r = 0; r < 3; r++)
        for (c = 0; c < 3; c++)
            s[3 * r + c] = rotation[r] * f[c] + rotation[3 + r] * f[3 + c] + rotation[6 + r] * f[6 + c];
    trace = s[0] + s[4] + s[8];
    for (r = 0; r < 3; r++)
        for (c = 0; c < 3; c++) a[3 * r + c] = (r == c ? trace : 0) - 0.5 * (s[3 * r + c] + s[3 * c + r]);
    gxsp_cofactors(a, inverse);
    determinant = a[0] * inverse[0] + a[1] * inverse[1] + a[2] * inverse[2];
    axis[0] = s[7] - s[5], axis[1] = s[2] - s[6], axis[2] = s[3] - s[1];
    if (fabs(determinant) <= 1e-6 * fabs(trace * trace * trace)) return;
    for (r = 0; r < 3; r++)
        omega[r] = (inverse[r] * axis[0] + inverse[3 + r] * axis[1] + inverse[6 + r] * axis[2]) / determinant;
    for (r = 0; r < 3; r++) {
        const double *from = rotation + 3 * r;
        rotated[3 * r] = from[0] + from[1] * omega[2] - from[2] * omega[1];
        rotated[3 * r + 1] = from[1] - from[0] * omega[2] + from[2] * omega[0];
        rotated[3 * r + 2] = from[2] + from[0] * omega[1] - from[1] * omega[0];
    }
    for (r = 0; r < 3; r++)
        for (c = 0; c < 3; c++)
            square[3 * r + c] = (r == c ? 1.5 : 0) - 0.5 * (rotated[r] * rotated[c] + rotated[3 + r] * rotated[3 + c] +
                                                            rotated[6 + r] * rotated[6 + c]);
    for (r = 0; r < 3; r++)
        for (c = 0; c < 3; c++) {
            double sum = 0;
            for (k = 0; k < 3; k++) sum += rotated[3 * r + k] * square[3 * k + c];
            rotation[3 * r + c] = sum;
        }
}

/* >>material: energies and stresses -------------------------------------------------------------------------------- */

/* In: G = F - 1, so that nothing cancels near rest. Out: energy density (J/m3), first Piola-Kirchhoff stress P
 * (Pa), and the size of the terms whose rounding the energy carries. */

static gxsp_material gxsp_material_make(const gxs_material *given) {
    double shear = given->young / (2 * (1 + given->poisson));
    double lame = given->young * given->poisson / ((1 + given->poisson) * (1 - 2 * given->poisson));
    gxsp_material material;
    material.kind = given->kind;
    material.mu = shear;
    material.lambda = lame;
    material.damping = given->damping;
    material.energy = given->energy;
    material.user = given->user;
    /* in small strain the Lame constants are mu', lambda' [Smith 2018, 3.4] */
    if (given->kind == GXS_STABLE_NEO_HOOKEAN) {
        material.mu = 4.0 / 3 * shear;
        material.lambda = lame + 5.0 / 6 * shear;
    }
    if (given->kind == GXS_CUSTOM) {
        material.mu = 1;
        material.lambda = given->young;
    }
    return material;
}

/* Energy density and stress of a block, and their arguments */
typedef struct gxsp_state {
    gxsp_lanes g[9]; /* displacement gradient, by rows */
    gxsp_lanes p[9]; /* first Piola-Kirchhoff stress */
    gxsp_lanes energy, size;
    gxsp_lanes mu, lambda;
    const gxsp_material *material[GXSP_LANES]; /* of GXS_CUSTOM only */
} gxsp_state;

/* Stable neo-Hookean with the origin barrier [Smith 2018]:
 *   psi = mu/2 (Ic - 3) + lambda/2 (J - alpha)^2 - mu/2 log(Ic + 1) + constant,   Ic = |F|^2, J = det F,
 *   alpha = 1 + 3/4 mu/lambda: no stress at rest. With t = tr G, i = Ic - 3, j = J - 1:
 *   psi = 3/8 mu (|G|^2 + tr G^2 - t^2 - 2 det G) + mu/2 (x - log(1 + x)) + lambda/2 j^2,   x = i/4
 *   P   = 3/4 mu (G + G^T - t 1 - cof G) + mu/4 i/(Ic + 1) F + lambda j cof F,   cof F = (1 + t) 1 - G^T + cof G */
static void gxsp_neo_hookean(gxsp_state *GXSP_RESTRICT s) {
    int l;
    GXSP_EACH_LANE(l) {
        const double a = s->g[0][l], b = s->g[1][l], c = s->g[2][l], d = s->g[3][l], e = s->g[4][l], f = s->g[5][l],
                     g = s->g[6][l], h = s->g[7][l], k = s->g[8][l];
        const double c0 = e * k - f * h, c1 = f * g - d * k, c2 = d * h - e * g, c3 = c * h - b * k, c4 = a * k - c * g,
                     c5 = b * g - a * h, c6 = b * f - c * e, c7 = c * d - a * f, c8 = a * e - b * d;
        const double t = a + e + k, det = a * c0 + b * c1 + c * c2;
        const double square = a * a + b * b + c * c + d * d + e * e + f * f + g * g + h * h + k * k;
        const double i = 2 * t + square, j = t + (c0 + c4 + c8) + det;
        const double turned = a * a + e * e + k * k + 2 * (b * d + c * g + f * h);
        const double mu = s->mu[l], lambda = s->lambda[l], volume = 0.5 * lambda * j * j;
        const double rest = 0.75 * mu, growth = 0.25 * mu * i / (i + 4), pressure = lambda * j;
        const double own = rest + growth, other = rest - pressure, cofactor = pressure - rest;
        const double unit = pressure * (1 + t) + growth - rest * t;
        s->energy[l] = 0.375 * mu * (square + turned - t * t - 2 * det) + 0.5 * mu * gxsp_log_rest(0.25 * i) + volume;
        s->size[l] = mu * square + volume;
        s->p[0][l] = own * a + other * a + cofactor * c0 + unit;
        s->p[1][l] = own * b + other * d + cofactor * c1;
        s->p[2][l] = own * c + other * g + cofactor * c2;
        s->p[3][l] = own * d + other * b + cofactor * c3;
        s->p[4][l] = own * e + other * e + cofactor * c4 + unit;
        s->p[5][l] = own * f + other * h + cofactor * c5;
        s->p[6][l] = own * g + other * c + cofactor * c6;
        s->p[7][l] = own * h + other * f + cofactor * c7;
        s->p[8][l] = own * k + other * k + cofactor * c8 + unit;
    }
}

/* St. Venant-Kirchhoff, psi = mu E:E + lambda/2 (tr E)^2, E = (F^T F - 1) / 2, P = F (2 mu E + lambda tr E 1); and its
 * linearisation at rest: E = (G + G^T) / 2, P = 2 mu E + lambda tr E 1. bend: 1 or, for the linear material, 0. */
static void gxsp_kirchhoff(gxsp_state *GXSP_RESTRICT s, double bend) {
    int l;
    GXSP_EACH_LANE(l) {
        const double a = s->g[0][l], b = s->g[1][l], c = s->g[2][l], d = s->g[3][l], e = s->g[4][l], f = s->g[5][l],
                     g = s->g[6][l], h = s->g[7][l], k = s->g[8][l], mu = s->mu[l], lambda = s->lambda[l],
                     half = 0.5 * bend;
        const double e0 = a + half * (a * a + d * d + g * g), e4 = e + half * (b * b + e * e + h * h),
                     e8 = k + half * (c * c + f * f + k * k), e1 = 0.5 * (b + d) + half * (a * b + d * e + g * h),
                     e2 = 0.5 * (c + g) + half * (a * c + d * f + g * k),
                     e5 = 0.5 * (f + h) + half * (b * c + e * f + h * k);
        const double trace = e0 + e4 + e8, pressure = lambda * trace;
        const double s0 = 2 * mu * e0 + pressure, s4 = 2 * mu * e4 + pressure, s8 = 2 * mu * e8 + pressure,
                     s1 = 2 * mu * e1, s2 = 2 * mu * e2, s5 = 2 * mu * e5;
        s->energy[l] = mu * (e0 * e0 + e4 * e4 + e8 * e8 + 2 * (e1 * e1 + e2 * e2 + e5 * e5)) + 0.5 * pressure * trace;
        s->size[l] = s->energy[l];
        s->p[0][l] = s0 + bend * (a * s0 + b * s1 + c * s2);
        s->p[1][l] = s1 + bend * (a * s1 + b * s4 + c * s5);
        s->p[2][l] = s2 + bend * (a * s2 + b * s5 + c * s8);
        s->p[3][l] = s1 + bend * (d * s0 + e * s1 + f * s2);
        s->p[4][l] = s4 + bend * (d * s1 + e * s4 + f * s5);
        s->p[5][l] = s5 + bend * (d * s2 + e * s5 + f * s8);
        s->p[6][l] = s2 + bend * (g * s0 + h * s1 + k * s2);
        s->p[7][l] = s5 + bend * (g * s1 + h * s4 + k * s5);
        s->p[8][l] = s8 + bend * (g * s2 + h * s5 + k * s8);
    }
}

/* Fixed corotated [Stomakhin 2012]: psi = mu |F - R|^2 + lambda/2 (J - 1)^2, P = 2 mu (F - R) + lambda (J - 1) cof F, R
 * the rotation of F's polar decomposition. R = U V^T is known to single precision; each Newton step for the rotation
 * that makes R^T F symmetric squares the error. */
static void gxsp_corotated(gxsp_state *GXSP_RESTRICT s) {
    gxsp_svd svd;
    int l, r, c, k, round;
    gxsp_decompose(s->g, NULL, &svd);
    for (l = 0; l < GXSP_LANES; l++) {
        double f[9], rotation[9], cofactor[9], j, strain = 0;
        for (k = 0; k < 9; k++) f[k] = s->g[k][l] + (k % 4 == 0 ? 1 : 0);
        for (r = 0; r < 3; r++)
            for (c = 0; c < 3; c++)
                rotation[3 * r + c] = (double)svd.u[3 * r][l] * svd.v[3 * c][l] +
                                      (double)svd.u[3 * r + 1][l] * svd.v[3 * c + 1][l] +
                                      (double)svd.u[3 * r + 2][l] * svd.v[3 * c + 2][l];
        for (round = 0; round < 2; round++) gxsp_polish_rotation(f, rotation);
        gxsp_cofactors(f, cofactor);
        j = f[0] * cofactor[0] + f[1] * cofactor[1] + f[2] * cofactor[2] - 1;
        for (k = 0; k < 9; k++) {
            double gap = f[k] - rotation[k];
            strain += gap * gap;
            s->p[k][l] = 2 * s->mu[l] * gap + s->lambda[l] * j * cofactor[k];
        }
        s->energy[l] = s->mu[l] * strain + 0.5 * s->lambda[l] * j * j;
        s->size[l] = s->energy[l] + 1e-16 * s->mu[l];
    }
}

/* The caller's energy, one element after the other */
static void gxsp_custom(gxsp_state *s) {
    int k, l;
    for (l = 0; l < GXSP_LANES; l++) {
        double f[9], p[9];
        for (k = 0; k < 9; k++) f[k] = s->g[k][l] + (k % 4 == 0 ? 1 : 0);
        s->energy[l] = s->mu[l] * s->material[l]->energy(s->material[l]->user, f, p, NULL);
        /* its rounding is not known: take that of terms as large as its stiffness */
        s->size[l] = fabs(s->energy[l]) + s->lambda[l];
        for (k = 0; k < 9; k++) s->p[k][l] = s->mu[l] * p[k];
    }
}

/* Energy and stress of a block at s->g */
static void gxsp_material_state(gxs_material_kind kind, gxsp_state *s) {
    switch (kind) {
    case GXS_CUSTOM: gxsp_custom(s); break;
    case GXS_ST_VENANT_KIRCHHOFF: gxsp_kirchhoff(s, 1); break;
    case GXS_FIXED_COROTATED: gxsp_corotated(s); break;
    case GXS_LINEAR: gxsp_kirchhoff(s, 0); break;
    default: gxsp_neo_hookean(s); break;
    }
}

/* >>tangent: Hessian of one block ---------------------------------------------------------------------------------- */

/* The Hessian of psi at F = diag(s), projected. Every isotropic energy has this form: a 3x3 of the stretches, and
 * for each pair (F_ij, F_ji), k the third index, a 2x2. The eigenvalues of the 2x2 are flip = (psi_i - psi_j) /
 * (s_i - s_j) for F_ij = F_ji and twist = (psi_i + psi_j) / (s_i + s_j) for F_ij = -F_ji, where psi_i = d psi / d
 * s_i. even and odd are half their sum and half their difference. */

typedef struct gxsp_principal {
    gxsp_singles mu, lambda, weight;
    gxsp_singles stretch[6], flip[3], twist[3];
} gxsp_principal;

static void gxsp_neo_hookean_principal(const gxsp_svd *GXSP_RESTRICT svd, gxsp_principal *GXSP_RESTRICT to) {
    int l;
    GXSP_EACH_LANE(l) { /* eigensystem of [Smith 2018] */
        const float a = svd->s[0][l], b = svd->s[1][l], c = svd->s[2][l], mu = to->mu[l], lambda = to->lambda[l];
        const float square = a * a + b * b + c * c, whole = 1 / (square + 1), direct = mu * square * whole;
        const float along = 2 * mu * whole * whole, x = b * c, y = c * a, z = a * b;
        const float pressure = lambda * (a * x - 1) - 0.75f * mu; /* lambda (J - alpha) */
        to->stretch[0][l] = along * a * a + lambda * x * x + direct;
        to->stretch[1][l] = along * a * b + lambda * x * y + pressure * c;
        to->stretch[2][l] = along * a * c + lambda * x * z + pressure * b;
        to->stretch[3][l] = along * b * b + lambda * y * y + direct;
        to->stretch[4][l] = along * b * c + lambda * y * z + pressure * a;
        to->stretch[5][l] = along * c * c + lambda * z * z + direct;
        to->flip[0][l] = direct - pressure * a, to->twist[0][l] = direct + pressure * a;
        to->flip[1][l] = direct - pressure * b, to->twist[1][l] = direct + pressure * b;
        to->flip[2][l] = direct - pressure * c, to->twist[2][l] = direct + pressure * c;
    }
}

static void gxsp_kirchhoff_principal(const gxsp_svd *GXSP_RESTRICT svd, gxsp_principal *GXSP_RESTRICT to) {
    int l;
    GXSP_EACH_LANE(l) { /* psi_i = s_i (mu (s_i^2 - 1) + lambda/2 sum (s^2 - 1)) */
        const float a = svd->s[0][l], b = svd->s[1][l], c = svd->s[2][l], mu = to->mu[l], lambda = to->lambda[l];
        const float x = a * a, y = b * b, z = c * c, common = 0.5f * lambda * (x + y + z - 3) - mu;
        to->stretch[0][l] = (3 * mu + lambda) * x + common;
        to->stretch[1][l] = lambda * a * b;
        to->stretch[2][l] = lambda * a * c;
        to->stretch[3][l] = (3 * mu + lambda) * y + common;
        to->stretch[4][l] = lambda * b * c;
        to->stretch[5][l] = (3 * mu + lambda) * z + common;
        to->flip[0][l] = mu * (y + b * c + z) + common, to->twist[0][l] = mu * (y - b * c + z) + common;
        to->flip[1][l] = mu * (z + c * a + x) + common, to->twist[1][l] = mu * (z - c * a + x) + common;
        to->flip[2][l] = mu * (x + a * b + y) + common, to->twist[2][l] = mu * (x - a * b + y) + common;
    }
}

static void gxsp_corotated_principal(const gxsp_svd *GXSP_RESTRICT svd, gxsp_principal *GXSP_RESTRICT to) {
    int l;
    GXSP_EACH_LANE(l) { /* psi_i = 2 mu (s_i - 1) + lambda (J - 1) s_j s_k */
        const float a = svd->s[0][l], b = svd->s[1][l], c = svd->s[2][l], mu = to->mu[l], lambda = to->lambda[l];
        const float x = b * c, y = c * a, z = a * b, pressure = lambda * (a * x - 1), least = 1e-6f;
        const float bc = b + c > least ? b + c : least, ca = c + a > least ? c + a : least,
                    ab = a + b > least ? a + b : least;
        to->stretch[0][l] = 2 * mu + lambda * x * x;
        to->stretch[1][l] = lambda * x * y + pressure * c;
        to->stretch[2][l] = lambda * x * z + pressure * b;
        to->stretch[3][l] = 2 * mu + lambda * y * y;
        to->stretch[4][l] = lambda * y * z + pressure * a;
        to->stretch[5][l] = 2 * mu + lambda * z * z;
        to->flip[0][l] = 2 * mu - pressure * a, to->twist[0][l] = 2 * mu - 4 * mu / bc + pressure * a;
        to->flip[1][l] = 2 * mu - pressure * b, to->twist[1][l] = 2 * mu - 4 * mu / ca + pressure * b;
        to->flip[2][l] = 2 * mu - pressure * c, to->twist[2][l] = 2 * mu - 4 * mu / ab + pressure * c;
    }
}

/* The Hessian is the same at every F: U and V are 1. */
static void gxsp_linear_principal(gxsp_svd *GXSP_RESTRICT svd, gxsp_principal *GXSP_RESTRICT to) {
    int k, l;
    for (k = 0; k < 9; k++) GXSP_EACH_LANE(l) svd->u[k][l] = svd->v[k][l] = k % 4 == 0 ? 1.0f : 0.0f;
    GXSP_EACH_LANE(l) {
        const float mu = to->mu[l], lambda = to->lambda[l];
        to->stretch[0][l] = to->stretch[3][l] = to->stretch[5][l] = 2 * mu + lambda;
        to->stretch[1][l] = to->stretch[2][l] = to->stretch[4][l] = lambda;
        to->flip[0][l] = to->flip[1][l] = to->flip[2][l] = 2 * mu;
        to->twist[0][l] = to->twist[1][l] = to->twist[2][l] = 0;
    }
}

/* One Jacobi rotation of the symmetric a (n x n) that makes a_ij zero. The columns of v are rotated too. */
static void gxsp_diagonalise(double *a, double *v, int n, int i, int j) {
    double zeta, t, c, s;
    int k;
    if (a[n * i + j] * a[n * i + j] <= 1e-32 * fabs(a[n * i + i] * a[n * j + j])) return;
    zeta = (a[n * j + j] - a[n * i + i]) / (2 * a[n * i + j]);
    t = (zeta < 0 ? -1 : 1) / (fabs(zeta) + sqrt(1 + zeta * zeta));
    c = 1 / sqrt(1 + t * t);
    s = c * t;
    for (k = 0; k < n; k++) {
        double ai = a[n * i + k], aj = a[n * j + k];
        a[n * i + k] = c * ai - s * aj, a[n * j + k] = s * ai + c * aj;
    }
    for (k = 0; k < n * n; k += n) {
        double ai = a[k + i], aj = a[k + j], vi = v[k + i], vj = v[k + j];
        a[k + i] = c * ai - s * aj, a[k + j] = s * ai + c * aj;
        v[k + i] = c * vi - s * vj, v[k + j] = s * vi + c * vj;
    }
}

/* Replaces the symmetric a (n x n, n at most 9) by the nearest semi-definite one: negative eigenvalues become 0. */
static void gxsp_project_symmetric(double *a, int n) {
    double v[81], value[9];
    int sweep, i, j, k;
    for (k = 0; k < n * n; k++) v[k] = k % (n + 1) == 0 ? 1 : 0;
    for (sweep = 0; sweep < 5 + n; sweep++) /* converges quadratically: 5 reach rounding for 3x3 */
        for (i = 0; i < n; i++)
            for (j = i + 1; j < n; j++) gxsp_diagonalise(a, v, n, i, j);
    for (k = 0; k < n; k++) value[k] = a[(n + 1) * k] > 0 ? a[(n + 1) * k] : 0;
    for (i = 0; i < n; i++)
        for (j = 0; j < n; j++) {
            a[n * i + j] = 0;
            for (k = 0; k < n; k++) a[n * i + j] += value[k] * v[n * i + k] * v[n * j + k];
        }
}

static void gxsp_project_lane(gxsp_singles *stretch, int lane) {
    double a[9];
    int i, j;
    for (i = 0; i < 3; i++)
        for (j = i; j < 3; j++) a[3 * i + j] = a[3 * j + i] = (double)stretch[gxsp_packed3(i, j)][lane];
    gxsp_project_symmetric(a, 3);
    for (i = 0; i < 3; i++)
        for (j = i; j < 3; j++) stretch[gxsp_packed3(i, j)][lane] = (float)a[3 * i + j];
}

/* Projects the 3x3 of the stretches in lanes where it is not positive definite, which leading minors by elimination
 * decide. */
static void gxsp_project(gxsp_principal *GXSP_RESTRICT principal) {
    gxsp_singles least;
    int l;
    GXSP_EACH_LANE(l) {
        const float a = principal->stretch[0][l], tiny = 1e-30f, p = a > tiny ? a : tiny;
        const float b = principal->stretch[1][l] / p, c = principal->stretch[2][l] / p;
        const float d = principal->stretch[3][l] - b * principal->stretch[1][l], q = d > tiny ? d : tiny;
        const float e = principal->stretch[4][l] - b * principal->stretch[2][l];
        const float f = principal->stretch[5][l] - c * principal->stretch[2][l] - e * e / q;
        const float low = a < d ? a : d;
        least[l] = low < f ? low : f;
    }
    for (l = 0; l < GXSP_LANES; l++)
        if (!(least[l] > 0)) gxsp_project_lane(principal->stretch, l);
}

/* The Hessian of a block of the caller's energy at s->g, times scale; exact or projected */
static void gxsp_general_make(const gxsp_rest *rest, gxsp_lanes *gradients, double scale, int exact, gxsp_state *s,
                              gxsp_tangent *tangent, gxsp_general *general) {
    int k, l, i, j;
    for (l = 0; l < GXSP_LANES; l++) {
        double f[9], h[81];
        for (k = 0; k < 9; k++) {
            f[k] = s->g[k][l] + (k % 4 == 0 ? 1 : 0);
            tangent->gradient[k][l] = (float)gradients[k][l];
        }
        s->material[l]->energy(s->material[l]->user, f, NULL, h);
        if (!exact) gxsp_project_symmetric(h, 9);
        for (i = 0; i < 9; i++)
            for (j = i; j < 9; j++)
                general->hessian[gxsp_packed9(i, j)][l] = (float)(scale * rest->weight[l] * s->mu[l] * h[9 * i + j]);
    }
}

/* Sets F = GXSP_NUDGE in elements collapsed to a point, F = 0. Returns whether there were any. */
static int gxsp_nudge(gxsp_lanes *g) {
    gxsp_lanes square;
    int k, l, any = 0;
    GXSP_EACH_LANE(l) square[l] = 0;
    for (k = 0; k < 9; k++) GXSP_EACH_LANE(l) {
            const double f = g[k][l] + (k % 4 == 0 ? 1 : 0);
            square[l] += f * f;
        }
    for (l = 0; l < GXSP_LANES; l++)
        if (square[l] < GXSP_COLLAPSED * GXSP_COLLAPSED) {
            for (k = 0; k < 9; k++) g[k][l] = k % 4 == 0 ? GXSP_NUDGE - 1 : 0;
            any = 1;
        }
    return any;
}

/* sqrt 2 times the unit quaternions of the rotations u, by rows. Starts from the largest of the four numbers: 4 q_i
 * q_j are sums of entries of u. */
static void gxsp_pack_rotation(gxsp_singles *GXSP_RESTRICT u, gxsp_singles *GXSP_RESTRICT frame) {
    int l;
    GXSP_EACH_LANE(l) {
        const float a = u[0][l], b = u[4][l], c = u[8][l];
        const float xx = 1 + a - b - c, yy = 1 - a + b - c, zz = 1 - a - b + c, ww = 1 + a + b + c;
        const float xy = gxsp_clean(u[1][l] + u[3][l]), xz = gxsp_clean(u[2][l] + u[6][l]),
                    yz = gxsp_clean(u[5][l] + u[7][l]);
        const float xw = gxsp_clean(u[7][l] - u[5][l]), yw = gxsp_clean(u[2][l] - u[6][l]),
                    zw = gxsp_clean(u[3][l] - u[1][l]);
        const float first = xx > yy ? xx : yy, second = zz > ww ? zz : ww;
        const float half = first > second ? 1.0f : 0.0f, one = half * (xx > yy ? 1.0f : 0.0f), two = half - one;
        const float three = (1 - half) * (zz > ww ? 1.0f : 0.0f), four = 1 - half - three;
        const float x = one * xx + two * xy + three * xz + four * xw, y = one * xy + two * yy + three * yz + four * yw;
        const float z = one * xz + two * yz + three * zz + four * zw, w = one * xw + two * yw + three * zw + four * ww;
        const float scale = gxsp_rsqrt(0.5f * (x * x + y * y + z * z + w * w));
        frame[0][l] = scale * x, frame[1][l] = scale * y, frame[2][l] = scale * z, frame[3][l] = scale * w;
    }
}

/* The SVD that Hessians of one or two blocks of a kind need; last: NULL if there is one block. Returns whether an
 * element was collapsed. */
static int gxsp_tangent_begin(gxs_material_kind kind, gxsp_state *first, gxsp_state *last, gxsp_svd *svd) {
    int collapsed;
    if (kind == GXS_CUSTOM || kind == GXS_LINEAR) return 0;
    collapsed = gxsp_nudge(first->g);
    collapsed |= last && gxsp_nudge(last->g);
    gxsp_decompose(first->g, last ? last->g : NULL, svd);
    return collapsed;
}

/* Arguments of principal Hessians, scaled so that single precision holds them: moduli relative to their sum, by
 * which weights grow, and clamped stretches */
static void gxsp_scale_principal(gxs_material_kind kind, const gxsp_rest *GXSP_RESTRICT rest, double scale,
                                 gxsp_state *GXSP_RESTRICT s, gxsp_svd *GXSP_RESTRICT svd,
                                 gxsp_principal *GXSP_RESTRICT to) {
    gxsp_lanes weight;
    int k, l;
    GXSP_EACH_LANE(l) {
        const double modulus = s->mu[l] + s->lambda[l];
        to->mu[l] = (float)(s->mu[l] / modulus);
        to->lambda[l] = (float)(s->lambda[l] / modulus);
        weight[l] = scale * rest->weight[l] * modulus;
    }
    for (l = 0; l < GXSP_LANES && kind != GXS_LINEAR; l++) { /* its Hessians have no stretches */
        const double a = (double)svd->s[0][l] * (double)svd->s[0][l], b = (double)svd->s[1][l] * (double)svd->s[1][l],
                     size = a * (b > 1 ? b : 1);
        if (size > GXSP_STRETCHED) {
            const double most = weight[l] > GXSP_HEAVIEST ? weight[l] : GXSP_HEAVIEST,
                         grown = weight[l] * (size / GXSP_STRETCHED);
            for (k = 0; k < 3; k++) svd->s[k][l] = (float)((double)svd->s[k][l] / sqrt(sqrt(size / GXSP_STRETCHED)));
            weight[l] = grown < most ? grown : most;
        }
    }
    GXSP_EACH_LANE(l) to->weight[l] = (float)weight[l];
}

/* The Hessian of a block at s->g, times scale; exact or projected. svd: by gxsp_tangent_begin. general: GXS_CUSTOM
 * only, else NULL. */
static void gxsp_tangent_make(gxs_material_kind kind, const gxsp_rest *GXSP_RESTRICT rest,
                              gxsp_lanes *GXSP_RESTRICT gradients, double scale, int exact, gxsp_state *s,
                              gxsp_svd *GXSP_RESTRICT svd, gxsp_tangent *GXSP_RESTRICT tangent, gxsp_general *general) {
    const float least = exact ? -FLT_MAX : 0;
    gxsp_principal principal;
    int k, l, r, c;
    if (kind == GXS_CUSTOM) {
        gxsp_general_make(rest, gradients, scale, exact, s, tangent, general);
        return;
    }
    gxsp_scale_principal(kind, rest, scale, s, svd, &principal);
    switch (kind) {
    case GXS_ST_VENANT_KIRCHHOFF: gxsp_kirchhoff_principal(svd, &principal); break;
    case GXS_FIXED_COROTATED: gxsp_corotated_principal(svd, &principal); break;
    case GXS_LINEAR: gxsp_linear_principal(svd, &principal); break;
    default: gxsp_neo_hookean_principal(svd, &principal); break;
    }
    if (!exact) gxsp_project(&principal);
    for (k = 0; k < 6; k++) GXSP_EACH_LANE(l) tangent->stretch[k][l] = principal.weight[l] * principal.stretch[k][l];
    for (k = 0; k < 3; k++) GXSP_EACH_LANE(l) {
            const float flip = principal.flip[k][l] > least ? principal.flip[k][l] : least;
            const float twist = principal.twist[k][l] > least ? principal.twist[k][l] : least;
            tangent->even[k][l] = 0.5f * principal.weight[l] * (flip + twist);
            tangent->odd[k][l] = 0.5f * principal.weight[l] * (flip - twist);
        }
    gxsp_pack_rotation(svd->u, tangent->frame);
    for (r = 0; r < 3; r++)
        for (c = 0; c < 3; c++) GXSP_EACH_LANE(l)
    tangent->gradient[3 * r + c][l] = (float)gradients[3 * r][l] * svd->v[c][l] +
                                      (float)gradients[3 * r + 1][l] * svd->v[3 + c][l] +
                                      (float)gradients[3 * r + 2][l] * svd->v[6 + c][l];
}

/* >>element: passes over one block --------------------------------------------------------------------------------- */

/* In: a block and vectors of its corners, x[3 corner + axis][lane]. Out: forces, products, and blocks of the
 * Hessian that couple two corners. Nothing else is read or written. */

/* Entries of gxs_element.mass */
static const int gxsp_packed_mass[4][4] = {{0, 1, 2, 3}, {1, 4, 5, 6}, {2, 5, 7, 8}, {3, 6, 8, 9}};

/* Gradients of shape functions 1 ... 3 of elements whose corners are at x, by rows; 0 in lanes without weight */
static void gxsp_gradients_make(const double *GXSP_RESTRICT weight, gxsp_lanes *GXSP_RESTRICT x,
                                gxsp_lanes *GXSP_RESTRICT gradients) {
    int l;
    GXSP_EACH_LANE(l) {
        const double a0 = x[3][l] - x[0][l], a1 = x[4][l] - x[1][l], a2 = x[5][l] - x[2][l], b0 = x[6][l] - x[0][l],
                     b1 = x[7][l] - x[1][l], b2 = x[8][l] - x[2][l], c0 = x[9][l] - x[0][l], c1 = x[10][l] - x[1][l],
                     c2 = x[11][l] - x[2][l];
        const double g0 = b1 * c2 - b2 * c1, g1 = b2 * c0 - b0 * c2, g2 = b0 * c1 - b1 * c0,
                     determinant = a0 * g0 + a1 * g1 + a2 * g2;
        const double scale = (weight[l] > 0 ? 1.0 : 0.0) / (weight[l] > 0 ? determinant : 1.0);
        gradients[0][l] = scale * g0, gradients[1][l] = scale * g1, gradients[2][l] = scale * g2;
        gradients[3][l] = scale * (c1 * a2 - c2 * a1), gradients[4][l] = scale * (c2 * a0 - c0 * a2),
        gradients[5][l] = scale * (c0 * a1 - c1 * a0);
        gradients[6][l] = scale * (a1 * b2 - a2 * b1), gradients[7][l] = scale * (a2 * b0 - a0 * b2),
        gradients[8][l] = scale * (a0 * b1 - a1 * b0);
    }
}

/* G = sum (u_i - u_0) grad N_i: exactly 0 for translations */
static void gxsp_block_gradient(gxsp_lanes *GXSP_RESTRICT gradients, gxsp_lanes *GXSP_RESTRICT x,
                                gxsp_lanes *GXSP_RESTRICT g) {
    int r, l;
    for (r = 0; r < 3; r++) GXSP_EACH_LANE(l) {
            const double a = x[3 + r][l] - x[r][l], b = x[6 + r][l] - x[r][l], c = x[9 + r][l] - x[r][l];
            g[3 * r][l] = a * gradients[0][l] + b * gradients[3][l] + c * gradients[6][l];
            g[3 * r + 1][l] = a * gradients[1][l] + b * gradients[4][l] + c * gradients[7][l];
            g[3 * r + 2][l] = a * gradients[2][l] + b * gradients[5][l] + c * gradients[8][l];
        }
}

/* force += weight x P : grad N. The four add up to zero but for rounding. */
static void gxsp_block_force(const double *GXSP_RESTRICT weight, gxsp_lanes *GXSP_RESTRICT gradients,
                             gxsp_lanes *GXSP_RESTRICT p, gxsp_lanes *GXSP_RESTRICT force) {
    int r, l;
    for (r = 0; r < 3; r++) GXSP_EACH_LANE(l) {
            const double w = weight[l], x = w * p[3 * r][l], y = w * p[3 * r + 1][l], z = w * p[3 * r + 2][l];
            const double a = x * gradients[0][l] + y * gradients[1][l] + z * gradients[2][l];
            const double b = x * gradients[3][l] + y * gradients[4][l] + z * gradients[5][l];
            const double c = x * gradients[6][l] + y * gradients[7][l] + z * gradients[8][l];
            force[r][l] -= a + b + c;
            force[3 + r][l] += a;
            force[6 + r][l] += b;
            force[9 + r][l] += c;
        }
}

/* y += rate M x; energy = rate/2 x M x. moments: NULL where rest->mass is enough */
static void gxsp_block_inertia(const gxsp_rest *GXSP_RESTRICT rest, const gxsp_moments *GXSP_RESTRICT moments,
                               double rate, gxsp_lanes *GXSP_RESTRICT x, gxsp_lanes *GXSP_RESTRICT y,
                               double *GXSP_RESTRICT energy) {
    int r, l;
    GXSP_EACH_LANE(l) energy[l] = 0;
    for (r = 0; !moments && r < 3; r++) GXSP_EACH_LANE(l) {
            const double m = rate * rest->mass[l], a = x[r][l], b = x[3 + r][l], c = x[6 + r][l], d = x[9 + r][l];
            const double sum = a + b + c + d, fa = m * (sum + a), fb = m * (sum + b), fc = m * (sum + c),
                         fd = m * (sum + d);
            y[r][l] += fa, y[3 + r][l] += fb, y[6 + r][l] += fc, y[9 + r][l] += fd;
            energy[l] += 0.5 * (fa * a + fb * b + fc * c + fd * d);
        }
    for (r = 0; moments && r < 3; r++) GXSP_EACH_LANE(l) {
            const double m = rate * rest->mass[l], o = x[r][l], a = x[3 + r][l] - o, b = x[6 + r][l] - o,
                         c = x[9 + r][l] - o;
            const double ca = (double)moments->centre[0][l], cb = (double)moments->centre[1][l],
                         cc = (double)moments->centre[2][l];
            const double raa = (double)moments->root[0][l], rba = (double)moments->root[1][l],
                         rbb = (double)moments->root[2][l], rca = (double)moments->root[3][l],
                         rcb = (double)moments->root[4][l], rcc = (double)moments->root[5][l];
            const double mean = o + (ca * a + cb * b + cc * c), u = raa * a + rba * b + rca * c, v = rbb * b + rcb * c,
                         w = rcc * c;
            const double fa = m * (ca * mean + raa * u), fb = m * (cb * mean + rba * u + rbb * v),
                         fc = m * (cc * mean + rca * u + rcb * v + rcc * w);
            y[r][l] += m * mean - (fa + fb + fc), y[3 + r][l] += fa, y[6 + r][l] += fb, y[9 + r][l] += fc;
            energy[l] += 0.5 * m * (mean * mean + u * u + v * v + w * w);
        }
}

/* y += (K + rate M) x, one lane after the other in registers. m: NULL where elements are whole. relative: x of
 * corners 1 ... 3 is their difference to corner 0, which the caller knows more accurately than single precision
 * could. */
GXSP_INLINE void gxsp_block_product(const gxsp_tangent *GXSP_RESTRICT b, const gxsp_moments *GXSP_RESTRICT m,
                                    int relative, gxsp_singles *GXSP_RESTRICT x, gxsp_singles *GXSP_RESTRICT y) {
    int l;
    GXSP_EACH_LANE(l) {
        const float x0 = x[0][l], x1 = x[1][l], x2 = x[2][l];
        const float o0 = relative ? 0 : x0, o1 = relative ? 0 : x1, o2 = relative ? 0 : x2;
        const float g0 = b->gradient[0][l], g1 = b->gradient[1][l], g2 = b->gradient[2][l], g3 = b->gradient[3][l],
                    g4 = b->gradient[4][l], g5 = b->gradient[5][l], g6 = b->gradient[6][l], g7 = b->gradient[7][l],
                    g8 = b->gradient[8][l];
        const float a0 = x[3][l] - o0, a1 = x[4][l] - o1, a2 = x[5][l] - o2, b0 = x[6][l] - o0, b1 = x[7][l] - o1,
                    b2 = x[8][l] - o2, c0 = x[9][l] - o0, c1 = x[10][l] - o1, c2 = x[11][l] - o2;
        /* dF V = sum (x_i - x_0) (V^T grad N_i)^T */
        const float d0 = a0 * g0 + b0 * g3 + c0 * g6, d1 = a0 * g1 + b0 * g4 + c0 * g7,
                    d2 = a0 * g2 + b0 * g5 + c0 * g8, d3 = a1 * g0 + b1 * g3 + c1 * g6,
                    d4 = a1 * g1 + b1 * g4 + c1 * g7, d5 = a1 * g2 + b1 * g5 + c1 * g8,
                    d6 = a2 * g0 + b2 * g3 + c2 * g6, d7 = a2 * g1 + b2 * g4 + c2 * g7,
                    d8 = a2 * g2 + b2 * g5 + c2 * g8;
        const float q0 = b->frame[0][l], q1 = b->frame[1][l], q2 = b->frame[2][l], q3 = b->frame[3][l];
        const float u0 = 1 - (q1 * q1 + q2 * q2), u1 = q0 * q1 - q2 * q3, u2 = q0 * q2 + q1 * q3,
                    u3 = q0 * q1 + q2 * q3, u4 = 1 - (q0 * q0 + q2 * q2), u5 = q1 * q2 - q0 * q3,
                    u6 = q0 * q2 - q1 * q3, u7 = q1 * q2 + q0 * q3, u8 = 1 - (q0 * q0 + q1 * q1);
        /* t = U^T dF V */
        const float t0 = u0 * d0 + u3 * d3 + u6 * d6, t1 = u0 * d1 + u3 * d4 + u6 * d7,
                    t2 = u0 * d2 + u3 * d5 + u6 * d8, t3 = u1 * d0 + u4 * d3 + u7 * d6,
                    t4 = u1 * d1 + u4 * d4 + u7 * d7, t5 = u1 * d2 + u4 * d5 + u7 * d8,
                    t6 = u2 * d0 + u5 * d3 + u8 * d6, t7 = u2 * d1 + u5 * d4 + u8 * d7,
                    t8 = u2 * d2 + u5 * d5 + u8 * d8;
        /* s = weight h : t */
        const float s0 = b->stretch[0][l] * t0 + b->stretch[1][l] * t4 + b->stretch[2][l] * t8,
                    s4 = b->stretch[1][l] * t0 + b->stretch[3][l] * t4 + b->stretch[4][l] * t8,
                    s8 = b->stretch[2][l] * t0 + b->stretch[4][l] * t4 + b->stretch[5][l] * t8,
                    s1 = b->even[2][l] * t1 + b->odd[2][l] * t3, s3 = b->even[2][l] * t3 + b->odd[2][l] * t1,
                    s2 = b->even[1][l] * t2 + b->odd[1][l] * t6, s6 = b->even[1][l] * t6 + b->odd[1][l] * t2,
                    s5 = b->even[0][l] * t5 + b->odd[0][l] * t7, s7 = b->even[0][l] * t7 + b->odd[0][l] * t5;
        /* p = U s */
        const float p0 = u0 * s0 + u1 * s3 + u2 * s6, p1 = u0 * s1 + u1 * s4 + u2 * s7,
                    p2 = u0 * s2 + u1 * s5 + u2 * s8, p3 = u3 * s0 + u4 * s3 + u5 * s6,
                    p4 = u3 * s1 + u4 * s4 + u5 * s7, p5 = u3 * s2 + u4 * s5 + u5 * s8,
                    p6 = u6 * s0 + u7 * s3 + u8 * s6, p7 = u6 * s1 + u7 * s4 + u8 * s7,
                    p8 = u6 * s2 + u7 * s5 + u8 * s8;
        const float f0 = p0 * g0 + p1 * g1 + p2 * g2, f1 = p3 * g0 + p4 * g1 + p5 * g2,
                    f2 = p6 * g0 + p7 * g1 + p8 * g2, f3 = p0 * g3 + p1 * g4 + p2 * g5,
                    f4 = p3 * g3 + p4 * g4 + p5 * g5, f5 = p6 * g3 + p7 * g4 + p8 * g5,
                    f6 = p0 * g6 + p1 * g7 + p2 * g8, f7 = p3 * g6 + p4 * g7 + p5 * g8,
                    f8 = p6 * g6 + p7 * g7 + p8 * g8;
        if (m) {
            const float n = b->mass[l], k0 = m->centre[0][l], k1 = m->centre[1][l], k2 = m->centre[2][l],
                        r0 = m->root[0][l], r1 = m->root[1][l], r2 = m->root[2][l], r3 = m->root[3][l],
                        r4 = m->root[4][l], r5 = m->root[5][l];
            const float m0 = n * (x0 + (k0 * a0 + k1 * b0 + k2 * c0)), m1 = n * (x1 + (k0 * a1 + k1 * b1 + k2 * c1)),
                        m2 = n * (x2 + (k0 * a2 + k1 * b2 + k2 * c2));
            const float v0 = n * (r0 * a0 + r1 * b0 + r3 * c0), v1 = n * (r0 * a1 + r1 * b1 + r3 * c1),
                        v2 = n * (r0 * a2 + r1 * b2 + r3 * c2), v3 = n * (r2 * b0 + r4 * c0),
                        v4 = n * (r2 * b1 + r4 * c1), v5 = n * (r2 * b2 + r4 * c2), v6 = n * (r5 * c0),
                        v7 = n * (r5 * c1), v8 = n * (r5 * c2);
            const float h0 = k0 * m0 + r0 * v0 + f0, h1 = k0 * m1 + r0 * v1 + f1, h2 = k0 * m2 + r0 * v2 + f2,
                        h3 = k1 * m0 + r1 * v0 + r2 * v3 + f3, h4 = k1 * m1 + r1 * v1 + r2 * v4 + f4,
                        h5 = k1 * m2 + r1 * v2 + r2 * v5 + f5, h6 = k2 * m0 + r3 * v0 + r4 * v3 + r5 * v6 + f6,
                        h7 = k2 * m1 + r3 * v1 + r4 * v4 + r5 * v7 + f7,
                        h8 = k2 * m2 + r3 * v2 + r4 * v5 + r5 * v8 + f8;
            y[0][l] += m0 - (h0 + h3 + h6), y[1][l] += m1 - (h1 + h4 + h7), y[2][l] += m2 - (h2 + h5 + h8);
            y[3][l] += h0, y[4][l] += h1, y[5][l] += h2, y[6][l] += h3, y[7][l] += h4, y[8][l] += h5, y[9][l] += h6,
                y[10][l] += h7, y[11][l] += h8;
        } else {
            const float n = b->mass[l], m0 = n * (a0 + b0 + c0 + 5 * x0), m1 = n * (a1 + b1 + c1 + 5 * x1),
                        m2 = n * (a2 + b2 + c2 + 5 * x2);
            y[0][l] += m0 - (f0 + f3 + f6), y[1][l] += m1 - (f1 + f4 + f7), y[2][l] += m2 - (f2 + f5 + f8);
            y[3][l] += m0 + n * a0 + f0, y[4][l] += m1 + n * a1 + f1, y[5][l] += m2 + n * a2 + f2;
            y[6][l] += m0 + n * b0 + f3, y[7][l] += m1 + n * b1 + f4, y[8][l] += m2 + n * b2 + f5;
            y[9][l] += m0 + n * c0 + f6, y[10][l] += m1 + n * c1 + f7, y[11][l] += m2 + n * c2 + f8;
        }
    }
}

/* y += K x for a Hessian without a frame */
static void gxsp_general_product(const gxsp_tangent *b, const gxsp_general *h, int relative, gxsp_singles *x,
                                 gxsp_singles *y) {
    const float from = relative ? 0.0f : 1.0f;
    gxsp_singles d[9], p[9];
    int i, j, k, l;
    for (i = 0; i < 9; i++) GXSP_EACH_LANE(l) {
            const int r = i / 3, c = i % 3;
            const float o = from * x[r][l];
            d[i][l] = (x[3 + r][l] - o) * b->gradient[c][l] + (x[6 + r][l] - o) * b->gradient[3 + c][l] +
                      (x[9 + r][l] - o) * b->gradient[6 + c][l];
            p[i][l] = 0;
        }
    for (i = 0; i < 9; i++)
        for (j = 0; j < 9; j++) GXSP_EACH_LANE(l) p[i][l] += h->hessian[gxsp_packed9(i, j)][l] * d[j][l];
    for (i = 0; i < 3; i++) GXSP_EACH_LANE(l)
    for (k = 0; k < 3; k++) {
        const float f = p[3 * i][l] * b->gradient[3 * k][l] + p[3 * i + 1][l] * b->gradient[3 * k + 1][l] +
                        p[3 * i + 2][l] * b->gradient[3 * k + 2][l];
        y[3 + 3 * k + i][l] += f;
        y[i][l] -= f;
    }
}

/* c and R of a corner: out[0] and out[1 ... 3] */
static void gxsp_corner_moments(const gxsp_moments *moments, int corner, gxsp_singles *out) {
    int k, l;
    for (k = 0; k < 4; k++) GXSP_EACH_LANE(l) {
            const float a = k == 0 ? moments->centre[0][l] : k == 1 ? moments->root[0][l] : 0;
            const float b = k == 0 ? moments->centre[1][l] : k < 3 ? moments->root[k][l] : 0;
            const float c = k == 0 ? moments->centre[2][l] : moments->root[2 + k][l];
            out[k][l] = corner == 0 ? (k == 0 ? 1.0f : 0.0f) - (a + b + c) : corner == 1 ? a : corner == 2 ? b : c;
        }
}

/* M_pq x rate */
static void gxsp_block_mass(const gxsp_tangent *tangent, const gxsp_moments *moments, int p, int q, float *mass) {
    gxsp_singles corners[8];
    int l;
    if (moments) {
        gxsp_corner_moments(moments, p, corners);
        gxsp_corner_moments(moments, q, corners + 4);
        GXSP_EACH_LANE(l)
        mass[l] = tangent->mass[l] * (corners[0][l] * corners[4][l] + corners[1][l] * corners[5][l] +
                                      corners[2][l] * corners[6][l] + corners[3][l] * corners[7][l]);
    } else
        GXSP_EACH_LANE(l) mass[l] = tangent->mass[l] * (p == q ? 2.0f : 1.0f);
}

/* y += rate M x. relative: see gxsp_block_product */
static void gxsp_inertia_product(const gxsp_tangent *b, const gxsp_moments *moments, int relative, gxsp_singles *x,
                                 gxsp_singles *y) {
    gxsp_singles mass;
    int i, j, r, l;
    for (i = 0; i < 4; i++)
        for (j = 0; j < 4; j++) {
            gxsp_block_mass(b, moments, i, j, mass);
            for (r = 0; r < 3; r++)
                GXSP_EACH_LANE(l) y[3 * i + r][l] += mass[l] * (x[3 * j + r][l] + (relative && j > 0 ? x[r][l] : 0));
        }
}

/* y += (K + rate M) x for any kind of material */
GXSP_INLINE void gxsp_kind_product(gxs_material_kind kind, const gxsp_tangent *b, const gxsp_moments *m,
                                   const gxsp_general *h, int relative, gxsp_singles *x, gxsp_singles *y) {
    if (kind == GXS_CUSTOM) {
        gxsp_general_product(b, h, relative, x, y);
        gxsp_inertia_product(b, m, relative, x, y);
    } else if (m && relative)
        gxsp_block_product(b, m, 1, x, y);
    else if (m)
        gxsp_block_product(b, m, 0, x, y);
    else if (relative)
        gxsp_block_product(b, NULL, 1, x, y);
    else
        gxsp_block_product(b, NULL, 0, x, y);
}

static void gxsp_general_couple(const gxsp_general *general, gxsp_singles *p, gxsp_singles *q, gxsp_singles *block) {
    int r, s, k, m, l;
    for (r = 0; r < 3; r++)
        for (s = 0; s < 3; s++) {
            GXSP_EACH_LANE(l) block[3 * r + s][l] = 0;
            for (k = 0; k < 3; k++)
                for (m = 0; m < 3; m++) GXSP_EACH_LANE(l)
            block[3 * r + s][l] += general->hessian[gxsp_packed9(3 * r + k, 3 * s + m)][l] * p[k][l] * q[m][l];
        }
}

/* block = U B U^T, B_rs = sum h_rk,sl p_k q_l, by rows: the block of the Hessian that couples two shape functions.
 * p, q: their gradients in the frame of V */
static void gxsp_block_couple(const gxsp_tangent *GXSP_RESTRICT t, const gxsp_general *general, /* or NULL */
                              gxsp_singles *p, gxsp_singles *q,                                 /* may be the same */
                              gxsp_singles *GXSP_RESTRICT block) {
    int l;
    if (general) {
        gxsp_general_couple(general, p, q, block);
        return;
    }
    GXSP_EACH_LANE(l) {
        const float p0 = p[0][l], p1 = p[1][l], p2 = p[2][l], q0 = q[0][l], q1 = q[1][l], q2 = q[2][l];
        const float e0 = t->even[0][l], e1 = t->even[1][l], e2 = t->even[2][l], o0 = t->odd[0][l], o1 = t->odd[1][l],
                    o2 = t->odd[2][l];
        const float b0 = t->stretch[0][l] * p0 * q0 + e2 * p1 * q1 + e1 * p2 * q2,
                    b4 = t->stretch[3][l] * p1 * q1 + e2 * p0 * q0 + e0 * p2 * q2,
                    b8 = t->stretch[5][l] * p2 * q2 + e1 * p0 * q0 + e0 * p1 * q1,
                    b1 = t->stretch[1][l] * p0 * q1 + o2 * p1 * q0, b3 = t->stretch[1][l] * p1 * q0 + o2 * p0 * q1,
                    b2 = t->stretch[2][l] * p0 * q2 + o1 * p2 * q0, b6 = t->stretch[2][l] * p2 * q0 + o1 * p0 * q2,
                    b5 = t->stretch[4][l] * p1 * q2 + o0 * p2 * q1, b7 = t->stretch[4][l] * p2 * q1 + o0 * p1 * q2;
        const float r0 = t->frame[0][l], r1 = t->frame[1][l], r2 = t->frame[2][l], r3 = t->frame[3][l];
        const float u0 = 1 - (r1 * r1 + r2 * r2), u1 = r0 * r1 - r2 * r3, u2 = r0 * r2 + r1 * r3,
                    u3 = r0 * r1 + r2 * r3, u4 = 1 - (r0 * r0 + r2 * r2), u5 = r1 * r2 - r0 * r3,
                    u6 = r0 * r2 - r1 * r3, u7 = r1 * r2 + r0 * r3, u8 = 1 - (r0 * r0 + r1 * r1);
        const float a0 = u0 * b0 + u1 * b3 + u2 * b6, a1 = u0 * b1 + u1 * b4 + u2 * b7,
                    a2 = u0 * b2 + u1 * b5 + u2 * b8, a3 = u3 * b0 + u4 * b3 + u5 * b6,
                    a4 = u3 * b1 + u4 * b4 + u5 * b7, a5 = u3 * b2 + u4 * b5 + u5 * b8,
                    a6 = u6 * b0 + u7 * b3 + u8 * b6, a7 = u6 * b1 + u7 * b4 + u8 * b7,
                    a8 = u6 * b2 + u7 * b5 + u8 * b8;
        block[0][l] = a0 * u0 + a1 * u1 + a2 * u2, block[1][l] = a0 * u3 + a1 * u4 + a2 * u5,
        block[2][l] = a0 * u6 + a1 * u7 + a2 * u8;
        block[3][l] = a3 * u0 + a4 * u1 + a5 * u2, block[4][l] = a3 * u3 + a4 * u4 + a5 * u5,
        block[5][l] = a3 * u6 + a4 * u7 + a5 * u8;
        block[6][l] = a6 * u0 + a7 * u1 + a8 * u2, block[7][l] = a6 * u3 + a7 * u4 + a8 * u5,
        block[8][l] = a6 * u6 + a7 * u7 + a8 * u8;
    }
}

/* V^T grad N of corner 0 ... 3 */
static void gxsp_block_corner(const gxsp_tangent *GXSP_RESTRICT t, int corner, gxsp_singles *GXSP_RESTRICT gamma) {
    int k, l;
    for (k = 0; k < 3; k++) GXSP_EACH_LANE(l)
    gamma[k][l] = corner > 0 ? t->gradient[3 * (corner - 1) + k][l]
                             : -(t->gradient[k][l] + t->gradient[3 + k][l] + t->gradient[6 + k][l]);
}

/* U of a block's Hessian, by rows */
static void gxsp_block_frame(const gxsp_tangent *GXSP_RESTRICT t, gxsp_singles *GXSP_RESTRICT u) {
    int l;
    GXSP_EACH_LANE(l) {
        const float a = t->frame[0][l], b = t->frame[1][l], c = t->frame[2][l], d = t->frame[3][l];
        u[0][l] = 1 - (b * b + c * c), u[1][l] = a * b - c * d, u[2][l] = a * c + b * d;
        u[3][l] = a * b + c * d, u[4][l] = 1 - (a * a + c * c), u[5][l] = b * c - a * d;
        u[6][l] = a * c - b * d, u[7][l] = b * c + a * d, u[8][l] = 1 - (a * a + b * b);
    }
}

/* own += U B U^T, packed: couples a shape function with itself, B as in gxsp_block_couple. p: its gradient */
static void gxsp_block_own(const gxsp_tangent *GXSP_RESTRICT t, gxsp_singles *GXSP_RESTRICT u,
                           gxsp_singles *GXSP_RESTRICT p, gxsp_singles *GXSP_RESTRICT own) {
    int l;
    GXSP_EACH_LANE(l) {
        const float p0 = p[0][l], p1 = p[1][l], p2 = p[2][l], q0 = p0 * p0, q1 = p1 * p1, q2 = p2 * p2;
        const float e0 = t->even[0][l], e1 = t->even[1][l], e2 = t->even[2][l];
        const float b0 = t->stretch[0][l] * q0 + e2 * q1 + e1 * q2, b3 = t->stretch[3][l] * q1 + e2 * q0 + e0 * q2,
                    b5 = t->stretch[5][l] * q2 + e1 * q0 + e0 * q1, b1 = (t->stretch[1][l] + t->odd[2][l]) * p0 * p1,
                    b2 = (t->stretch[2][l] + t->odd[1][l]) * p0 * p2, b4 = (t->stretch[4][l] + t->odd[0][l]) * p1 * p2;
        const float u0 = u[0][l], u1 = u[1][l], u2 = u[2][l], u3 = u[3][l], u4 = u[4][l], u5 = u[5][l], u6 = u[6][l],
                    u7 = u[7][l], u8 = u[8][l];
        const float a0 = u0 * b0 + u1 * b1 + u2 * b2, a1 = u0 * b1 + u1 * b3 + u2 * b4,
                    a2 = u0 * b2 + u1 * b4 + u2 * b5, a3 = u3 * b0 + u4 * b1 + u5 * b2,
                    a4 = u3 * b1 + u4 * b3 + u5 * b4, a5 = u3 * b2 + u4 * b4 + u5 * b5,
                    a6 = u6 * b0 + u7 * b1 + u8 * b2, a7 = u6 * b1 + u7 * b3 + u8 * b4,
                    a8 = u6 * b2 + u7 * b4 + u8 * b5;
        own[0][l] += a0 * u0 + a1 * u1 + a2 * u2, own[1][l] += a0 * u3 + a1 * u4 + a2 * u5,
            own[2][l] += a0 * u6 + a1 * u7 + a2 * u8;
        own[3][l] += a3 * u3 + a4 * u4 + a5 * u5, own[4][l] += a3 * u6 + a4 * u7 + a5 * u8,
            own[5][l] += a6 * u6 + a7 * u7 + a8 * u8;
    }
}

/* The same for a Hessian without a frame */
static void gxsp_general_own(const gxsp_general *general, gxsp_singles *p, gxsp_singles *own) {
    static const int packed[6] = {0, 1, 2, 4, 5, 8};
    gxsp_singles block[9];
    int k, l;
    gxsp_general_couple(general, p, p, block);
    for (k = 0; k < 6; k++) GXSP_EACH_LANE(l) own[k][l] += block[packed[k]][l];
}

/* Parameters of a block's materials */
static void gxsp_block_parameters(const gxsp_material *materials, const gxsp_rest *rest, gxsp_state *s) {
    int l;
    for (l = 0; l < GXSP_LANES; l++) {
        const gxsp_material *material = &materials[rest->material[l]];
        s->mu[l] = material->mu;
        s->lambda[l] = material->lambda;
        s->material[l] = material;
    }
}

/* Rotates P of elements by the rotation from their orientation at displacement gradients `from` to that at `to`. P
 * stays where that is more than a right angle: such an element is tangled. */
static void gxsp_rotate_stress(gxsp_lanes *from, gxsp_lanes *to, gxsp_lanes *p) {
    gxsp_svd svd[2];
    int r, c, k, l;
    gxsp_decompose(from, to, svd);
    for (l = 0; l < GXSP_LANES; l++) {
        double a[9], b[9], turn[9], stress[9], f[9], h[9];
        for (r = 0; r < 3; r++)
            for (c = 0; c < 3; c++) {
                a[3 * r + c] = b[3 * r + c] = 0;
                for (k = 0; k < 3; k++) {
                    a[3 * r + c] += (double)(svd[0].u[3 * r + k][l] * svd[0].v[3 * c + k][l]);
                    b[3 * r + c] += (double)(svd[1].u[3 * r + k][l] * svd[1].v[3 * c + k][l]);
                }
            }
        for (k = 0; k < 9; k++) {
            f[k] = from[k][l] + (k % 4 == 0 ? 1 : 0);
            h[k] = to[k][l] + (k % 4 == 0 ? 1 : 0);
        }
        /* otherwise each step's load would have its own single-precision error, and no body would come to rest */
        gxsp_polish_rotation(f, a);
        gxsp_polish_rotation(h, b);
        for (k = 0; k < 9; k++) {
            turn[k] =
                b[k / 3 * 3] * a[k % 3 * 3] + b[k / 3 * 3 + 1] * a[k % 3 * 3 + 1] + b[k / 3 * 3 + 2] * a[k % 3 * 3 + 2];
            stress[k] = p[k][l];
        }
        for (k = 0; k < 9 && turn[0] + turn[4] + turn[8] > 1; k++)
            p[k][l] = turn[k / 3 * 3] * stress[k % 3] + turn[k / 3 * 3 + 1] * stress[3 + k % 3] +
                      turn[k / 3 * 3 + 2] * stress[6 + k % 3];
    }
}

/* >>masses: an element's mass in its lane -------------------------------------------------------------------------- */

/* In: gxs_element.mass. Out: the mass of a whole element, or mass, centre and covariance of a part of one. */

/* Is the mass block m (1 + delta_ij), as that of a whole element, to the rounding of its ten integrals? */
static int gxsp_whole(const double *mass) {
    static const int own[10] = {2, 1, 1, 1, 2, 1, 1, 2, 1, 2};
    int k;
    for (k = 0; k < 10; k++)
        if (fabs(mass[k] - 0.5 * own[k] * mass[0]) > 1e-14 * mass[0]) return 0;
    return 1;
}

static const uint8_t gxsp_own_order[4] = {0, 1, 2, 3};

/* Returns an element's mass. centre: barycentric coordinates of its centre, row sums over their sum. rounded: the
 * same in whole units of 2^-24, 1 in sum and none below 0 */
static double gxsp_find_centre(const double *mass, double *centre, double *rounded) {
    const double unit = 16777216;
    double sum = 0;
    int k, j, most = 1;
    for (k = 0; k < 4; k++) {
        for (j = 0, centre[k] = 0; j < 4; j++) centre[k] += mass[gxsp_packed_mass[k][j]];
        sum += centre[k];
    }
    rounded[0] = 1;
    for (k = 3; k >= 0; k--) {
        centre[k] = sum > 0 ? centre[k] / sum : 0;
        if (k > 0) rounded[0] -= rounded[k] = floor(unit * centre[k] + 0.5) / unit;
    }
    most = rounded[2] > rounded[most] ? 2 : most;
    most = rounded[3] > rounded[most] ? 3 : most;
    if (rounded[0] < 0) rounded[most] += rounded[0], rounded[0] = 0;
    return sum > 0 ? sum : 0;
}

/* Mass of each corner: row sums, rounded as in the solver's moments */
static void gxsp_row_masses(const gxs_element *element, double *rows) {
    const int whole = gxsp_whole(element->mass);
    double centre[4], mass = whole ? 2.5 * element->mass[0] : gxsp_find_centre(element->mass, centre, rows);
    int k;
    for (k = 0; k < 4; k++) rows[k] = whole ? mass : mass * rows[k];
}

/* Does the element give corner i stiffness or mass? */
static int gxsp_supports(const gxs_element *element, int i) {
    double rows[4];
    if (element->weight > 0) return 1;
    gxsp_row_masses(element, rows);
    return rows[i] > 0;
}

/* A factor of a symmetric 3x3, which is overwritten: c = factor factor^T. Cholesky's method with the largest pivot
 * first, so that rounding stays small where the matrix is singular or indefinite. Columns are in the order of pivots:
 * the last one is across what is flat. */
static void gxsp_factor3(double c[3][3], double factor[3][3]) {
    int done[3] = {0, 0, 0}, step, i, j, k;
    memset(factor, 0, 9 * sizeof(double));
    for (step = 0; step < 3; step++) {
        double root;
        for (i = 0, k = -1; i < 3; i++)
            if (!done[i] && (k < 0 || c[i][i] > c[k][k])) k = i;
        if (!(c[k][k] > 0)) break;
        root = sqrt(c[k][k]);
        done[k] = 1;
        for (i = 0; i < 3; i++)
            if (!done[i]) {
                const double most = c[i][i] > 0 ? sqrt(c[i][i]) : 0;
                factor[i][step] = fabs(c[i][k]) < root * most ? c[i][k] / root : copysign(most, c[i][k]);
            }
        factor[k][step] = root;
        for (i = 0; i < 3; i++)
            for (j = 0; j < 3 && !done[i]; j++) c[i][j] -= factor[i][step] * factor[j][step];
    }
}

/* Rotates columns, which does not change factor factor^T, until the factor is lower triangular. */
static void gxsp_triangle3(double factor[3][3]) {
    int i, j, k;
    for (i = 0; i < 2; i++)
        for (j = i + 1; j < 3; j++) {
            const double length = sqrt(factor[i][i] * factor[i][i] + factor[i][j] * factor[i][j]);
            const double cosine = length > 0 ? factor[i][i] / length : 1, sine = length > 0 ? factor[i][j] / length : 0;
            for (k = i; k < 3; k++) {
                const double a = factor[k][i], b = factor[k][j];
                factor[k][i] = cosine * a + sine * b, factor[k][j] = cosine * b - sine * a;
            }
        }
}

/* Moments of a lane whose mass is not that of a whole element. Returns its mass. */
static double gxsp_place_moments(const double *mass, const uint8_t *order, gxsp_moments *moments, size_t lane) {
    double centre[4], rounded[4], covariance[3][3], root[3][3];
    const double sum = gxsp_find_centre(mass, centre, rounded), all = sum > 0 ? sum : 1;
    const uint8_t *own = order + 1;
    int i, j;
    for (i = 0; i < 3; i++)
        for (j = 0; j < 3; j++)
            covariance[i][j] = mass[gxsp_packed_mass[own[i]][own[j]]] / all - centre[own[i]] * centre[own[j]];
    gxsp_factor3(covariance, root);
    gxsp_triangle3(root);
    for (i = 0; i < 3; i++) {
        moments->centre[i][lane] = (float)rounded[own[i]];
        for (j = 0; j <= i; j++) moments->root[i * (i + 1) / 2 + j][lane] = (float)root[i][j];
    }
    return sum;
}

/* Puts an element into lane `place` of a chunk. order: corner of the element for each corner of the lane */
static void gxsp_place_element(const gxsp_chunk *chunk, const gxs_element *element, const uint8_t *order,
                               uint32_t place, uint32_t lumped) {
    gxsp_rest *rest = &chunk->rest[place / GXSP_LANES];
    size_t lane = place % GXSP_LANES;
    int i, k;
    for (i = 0; i < 3 && chunk->gradients; i++)
        for (k = 0; k < 3; k++)
            chunk->gradients[place / GXSP_LANES].entry[3 * i + k][lane] =
                order[1 + i] > 0 ? element->gradient[order[1 + i]][k]
                                 : -(element->gradient[1][k] + element->gradient[2][k] + element->gradient[3][k]);
    rest->weight[lane] = element->weight;
    rest->material[lane] = element->material;
    chunk->groups[place] = element->group % GXSP_GROUPS; /* a caller who does not update may leave it unset */
    if (chunk->moments)
        rest->mass[lane] = gxsp_place_moments(element->mass, order, &chunk->moments[place / GXSP_LANES], lane);
    else
        rest->mass[lane] = lumped ? 0 : 0.5 * element->mass[0];
}

/* >>order: the order of elements ----------------------------------------------------------------------------------- */

/* In: the model and the components of its copies. Out: elements sorted by class, then by component, then along a
 * curve through space, so that chunks have few nodes and sleep with their component. Sorting and forests of
 * joined indices serve later sections too. */

/* Forests of joined indices: the root of a tree is its least index. */
static uint32_t gxsp_root(uint32_t *parent, uint32_t i) {
    while (parent[i] != i) {
        parent[i] = parent[parent[i]];
        i = parent[i];
    }
    return i;
}

static void gxsp_join(uint32_t *parent, uint32_t i, uint32_t j) {
    if (parent[i] == parent[j]) return; /* nearly always they are joined */
    i = gxsp_root(parent, i);
    j = gxsp_root(parent, j);
    if (i < j)
        parent[j] = i;
    else
        parent[i] = j;
}

/* The ten bits of x with two zeros between neighbours */
static uint32_t gxsp_spread(uint32_t x) {
    x = (x | x << 16) & 0x030000ffu;
    x = (x | x << 8) & 0x0300f00fu;
    x = (x | x << 4) & 0x030c30c3u;
    return (x | x << 2) & 0x09249249u;
}

/* Position of a point along the Z-order curve through 1024^3 cells */
static uint32_t gxsp_curve(const double *point, const double *low, double per_cell) {
    uint32_t code = 0;
    int k;
    for (k = 0; k < 3; k++) {
        double cell = (point[k] - low[k]) * per_cell;
        code |= gxsp_spread(cell < 0 ? 0 : cell > 1023 ? 1023 : (uint32_t)cell) << k;
    }
    return code;
}

/* An element's place in the order: by class, then component, then curve. Sorting takes ten bits at a time, the last
 * first. */
typedef struct gxsp_sorted {
    uint32_t place, component, class_index;
    uint32_t index; /* of the element or, while components are sorted, of the component */
} gxsp_sorted;

static uint32_t gxsp_sorted_digit(const gxsp_sorted *item, int pass) {
    return pass < 3 ? item->place >> (10 * pass) & 1023u
         : pass < 6 ? item->component >> (10 * (pass - 3)) & 1023u
                    : item->class_index;
}

/* Stable radix sort, least digit first. A digit that is the same everywhere is skipped. other: room for as many */
static gxsp_sorted *gxsp_sort(gxsp_sorted *sorted, gxsp_sorted *other, size_t count) {
    int pass, digit;
    for (pass = 0; pass < 7; pass++) {
        size_t start[1025] = {0}, i;
        gxsp_sorted *swap = sorted;
        for (i = 0; i < count; i++) start[gxsp_sorted_digit(&sorted[i], pass) + 1]++;
        if (start[gxsp_sorted_digit(&sorted[0], pass) + 1] == count) continue;
        for (digit = 0; digit < 1024; digit++) start[digit + 1] += start[digit];
        for (i = 0; i < count; i++) other[start[gxsp_sorted_digit(&sorted[i], pass)]++] = sorted[i];
        sorted = other;
        other = swap;
    }
    return sorted;
}

/* Position of every element along the curve through the model's box */
static void gxsp_place_elements(const gxs_model *model, gxsp_sorted *sorted) {
    double low[3] = {0, 0, 0}, high[3] = {0, 0, 0}, extent = 0;
    size_t i;
    int k, r;
    for (i = 0; model->positions && i < model->copy_count; i++)
        for (k = 0; k < 3; k++) {
            double x = model->positions[3 * i + (size_t)k];
            low[k] = i == 0 || x < low[k] ? x : low[k];
            high[k] = i == 0 || x > high[k] ? x : high[k];
        }
    for (k = 0; k < 3; k++) extent = high[k] - low[k] > extent ? high[k] - low[k] : extent;
    for (i = 0; i < model->element_count && extent > 0; i++) {
        double centre[3] = {0, 0, 0};
        for (k = 0; k < 4; k++)
            for (r = 0; r < 3; r++)
                centre[r] += 0.25 * model->positions[3 * (size_t)model->elements[i].copy[k] + (size_t)r];
        sorted[i].place = gxsp_curve(centre, low, 1024 / extent);
    }
}

/* Ranks components in the order in which the curve first meets them. rank: by component */
static void gxsp_rank_components(const gxsp_system *system, const gxs_model *model, const gxsp_sorted *elements,
                                 gxsp_sorted *components, gxsp_sorted *other, uint32_t *rank) {
    size_t i;
    for (i = 0; i < system->model.component_count; i++) {
        components[i].index = (uint32_t)i;
        components[i].place = UINT32_MAX;
    }
    for (i = 0; i < model->element_count; i++) {
        gxsp_sorted *component = &components[system->model.component[model->elements[i].copy[0]]];
        component->place = elements[i].place < component->place ? elements[i].place : component->place;
    }
    components = gxsp_sort(components, other, system->model.component_count);
    for (i = 0; i < system->model.component_count; i++) rank[components[i].index] = (uint32_t)i;
}

/* Are an element's gradients those of the rest positions x of its corners, but for rounding? */
static int gxsp_is_placed(const gxs_element *element, const double x[4][3]) {
    double edge[3][3], made[3][3], determinant = 0, most = 0, off = 0;
    int i, k;
    for (i = 0; i < 3; i++)
        for (k = 0; k < 3; k++) edge[i][k] = x[1 + i][k] - x[0][k];
    for (i = 0; i < 3; i++) {
        const double *a = edge[(i + 1) % 3], *b = edge[(i + 2) % 3];
        made[i][0] = a[1] * b[2] - a[2] * b[1], made[i][1] = a[2] * b[0] - a[0] * b[2],
        made[i][2] = a[0] * b[1] - a[1] * b[0];
    }
    for (k = 0; k < 3; k++) determinant += edge[0][k] * made[0][k];
    if (!gxsp_finite(determinant) || !(fabs(determinant) >= DBL_MIN)) return 0;
    for (k = 0; k < 9; k++) {
        const double given = element->gradient[1 + k / 3][k % 3], found = made[k / 3][k % 3] / determinant;
        if (!gxsp_finite(found)) return 0;
        most = fabs(given) > most ? fabs(given) : most;
        off = fabs(given - found) > off ? fabs(given - found) : off;
    }
    return off <= GXSP_PLACED * most;
}

/* Class of an element; a chunk has elements of one class: 4 x kind + 2 x (gradients differ from those of the
 * positions) + (mass is not that of a whole element). positions: at 3 x copy, or, with origins (as in gxs_change),
 * at 3 x the copy's origin; NULL: there are none */
static uint32_t gxsp_class(gxs_material_kind kind, const gxs_element *element, uint32_t lumped, const double *positions,
                           const uint32_t *origins) {
    double x[4][3];
    int k;
    for (k = 0; k < 4 && positions; k++) {
        const uint32_t copy = origins ? origins[element->copy[k]] >> 1 : element->copy[k];
        memcpy(x[k], positions + 3 * (size_t)copy, sizeof x[k]);
    }
    return 4 * (uint32_t)kind + (positions && gxsp_is_placed(element, (const double(*)[3])x) ? 0u : 2u) +
           (lumped || gxsp_whole(element->mass) ? 0u : 1u);
}

/* The elements in their order, in scratch */
static gxsp_sorted *gxsp_order_elements(const gxsp_system *system, const gxs_model *model, gxsp_pool *scratch) {
    const size_t count = model->element_count, components = system->model.component_count,
                 most = count > components ? count : components;
    gxsp_sorted *sorted = (gxsp_sorted *)gxsp_take(scratch, count, sizeof *sorted);
    gxsp_sorted *other = (gxsp_sorted *)gxsp_take(scratch, most, sizeof *other);
    gxsp_sorted *ranked = (gxsp_sorted *)gxsp_take(scratch, components, sizeof *ranked);
    uint32_t *rank = (uint32_t *)gxsp_take(scratch, components, sizeof(uint32_t));
    size_t i;
    if (scratch->failed) return NULL;
    gxsp_place_elements(model, sorted);
    gxsp_rank_components(system, model, sorted, ranked, other, rank);
    for (i = 0; i < count; i++) {
        const gxs_element *element = &model->elements[i];
        sorted[i].index = (uint32_t)i;
        sorted[i].component = rank[system->model.component[element->copy[0]]];
        sorted[i].class_index =
            gxsp_class(model->materials[element->material].kind, element, model->lumped_mass, model->positions, NULL);
    }
    return gxsp_sort(sorted, other, count);
}

/* >>lanes: which element of a chunk goes to which lane ------------------------------------------------------------- */

/* In: nodes of a chunk's elements. Out: a lane for each element. Neighbours go to successive blocks, so that
 * elements of one block seldom share nodes: where they do, each sum into a slot waits for the one before. A pass over
 * blocks neither loads nor stores a corner that is the same as in the block before in every lane. Hence lanes are
 * filled with strips around an edge: four elements, each with all but one corner of the one before. */

/* Sorts ascending, by insertion. */
static void gxsp_sort_row(uint32_t *row, uint32_t count) {
    uint32_t i, j;
    for (i = 1; i < count; i++) {
        uint32_t value = row[i];
        for (j = i; j > 0 && row[j - 1] > value; j--) row[j] = row[j - 1];
        row[j] = value;
    }
}

/* Numbers of copies in the chunk at work */
typedef struct gxsp_numbers {
    uint32_t *local; /* n: the number; valid where stamp is the round */
    uint32_t *stamp; /* n, 0 at first */
    uint32_t round;  /* one per chunk */
} gxsp_numbers;

/* Numbers the nodes of a chunk in the order of their copies, which is that of memory. copies: of count elements,
 * GXSP_NONE where there is none; numbers of nodes replace them. Returns the number of nodes. */
static uint32_t gxsp_number_nodes(uint32_t (*copies)[4], uint32_t count, gxsp_numbers *numbers, uint32_t *nodes) {
    uint32_t e, i, k, found = 0;
    numbers->round++;
    for (e = 0; e < count; e++)
        for (k = 0; k < 4 && copies[e][0] != GXSP_NONE; k++)
            if (numbers->stamp[copies[e][k]] != numbers->round) {
                numbers->stamp[copies[e][k]] = numbers->round;
                nodes[found++] = copies[e][k];
            }
    gxsp_sort_row(nodes, found);
    for (i = 0; i < found; i++) numbers->local[nodes[i]] = i;
    for (e = 0; e < count; e++)
        for (k = 0; k < 4 && copies[e][k] != GXSP_NONE; k++) copies[e][k] = numbers->local[copies[e][k]];
    return found;
}

/* Corners of a chunk's blocks. nodes: by lane; GXSP_NONE: there is no element, and the lane keeps the corners of
 * the block before */
static void gxsp_set_corners(const gxsp_chunk *chunk, uint32_t (*nodes)[4]) {
    uint32_t b, l, k;
    for (b = 0; b < chunk->block_count; b++) {
        gxsp_corners *corner = &chunk->corners[b];
        const gxsp_corners *before = b > 0 ? corner - 1 : corner;
        chunk->changed[b] = b > 0 ? 0 : 15;
        for (k = 0; k < 4; k++)
            for (l = 0; l < GXSP_LANES; l++) {
                const uint32_t node = nodes[b * GXSP_LANES + l][k];
                corner->node[k][l] = node != GXSP_NONE ? (uint16_t)node : b > 0 ? before->node[k][l] : 0;
                chunk->changed[b] =
                    (uint8_t)(chunk->changed[b] | (corner->node[k][l] != before->node[k][l] ? 1u << k : 0u));
            }
    }
    chunk->changed[b] = 15;
}

enum { GXSP_STRIP = 4, GXSP_FACES = 4096 };

typedef struct gxsp_layout {
    uint32_t (*nodes)[4]; /* count: nodes of each element */
    uint32_t count;
    uint16_t across[GXSP_CHUNK][4]; /* the element beyond the face opposite the corner, or count */
    uint8_t placed[GXSP_CHUNK];
    uint16_t strip[GXSP_CHUNK];   /* elements of the strips of one length, one strip after the other */
    uint8_t turn[GXSP_CHUNK][4];  /* the order of their corners */
    uint16_t element[GXSP_CHUNK]; /* by lane: the element there, or count */
    uint8_t order[GXSP_CHUNK][4]; /* by lane */
} gxsp_layout;

/* Finds the corners of three nodes in an element. Returns the fourth corner; 4: not all three are there once. Has no
 * branches, which processors could not predict. */
static int gxsp_find_face(const uint32_t *element, const uint32_t *face, uint8_t *corners) {
    static const uint8_t corner_of[16] = {4, 0, 1, 4, 2, 4, 4, 4, 3, 4, 4, 4, 4, 4, 4, 4}; /* by its bit */
    unsigned met[3];
    int i;
    for (i = 0; i < 3; i++) {
        const uint32_t node = face[i];
        met[i] = (element[0] == node ? 1u : 0u) | (element[1] == node ? 2u : 0u) | (element[2] == node ? 4u : 0u) |
                 (element[3] == node ? 8u : 0u);
        corners[i] = corner_of[met[i]];
    }
    return (corners[0] | corners[1] | corners[2]) & 4 ? 4 : corner_of[15 & ~(met[0] | met[1] | met[2])];
}

/* The nodes of the face opposite a corner */
static void gxsp_face_of(const uint32_t *element, int corner, uint32_t *face) {
    int i;
    for (i = 0; i < 3; i++) face[i] = element[i < corner ? i : i + 1];
}

/* Fills across, with a hash table of the faces met so far. */
static void gxsp_find_across(gxsp_layout *layout) {
    uint16_t table[GXSP_FACES]; /* 4 x element + corner, from 1 */
    uint32_t f, place, face[3];
    uint8_t corners[3];
    memset(table, 0, sizeof table);
    for (f = 0; f < 4 * layout->count; f++) {
        layout->across[f / 4][f % 4] = (uint16_t)layout->count;
        gxsp_face_of(layout->nodes[f / 4], (int)(f % 4), face);
        for (place = (face[0] * face[0] + face[1] * face[1] + face[2] * face[2]) * 40503u / 16 % GXSP_FACES;
             table[place]; place = (place + 1) % GXSP_FACES) {
            const uint32_t other = (table[place] - 1u) / 4;
            const int corner = gxsp_find_face(layout->nodes[other], face, corners);
            if (corner != (int)((table[place] - 1u) % 4)) continue;
            layout->across[f / 4][f % 4] = (uint16_t)other;
            layout->across[other][corner] = (uint16_t)(f / 4);
            break;
        }
        if (!table[place]) table[place] = (uint16_t)(f + 1);
    }
}

/* Walks from the strip's first element around the edge of its first two corners. Are there length elements? */
static int gxsp_walk_strip(const gxsp_layout *layout, uint32_t length, uint16_t *strip, uint8_t (*order)[4]) {
    uint32_t i, k;
    for (i = 1; i < length; i++) {
        const uint32_t moving = i % 2 ? 2 : 3, e = layout->across[strip[i - 1]][order[i - 1][moving]];
        const uint32_t *before = layout->nodes[strip[i - 1]];
        uint32_t face[3];
        uint8_t corners[3] = {0, 0, 0};
        int other;
        if (e == layout->count || layout->placed[e]) return 0;
        for (k = 0; k < i; k++)
            if (strip[k] == e) return 0;
        face[0] = before[order[i - 1][0]], face[1] = before[order[i - 1][1]],
        face[2] = before[order[i - 1][5 - moving]];
        other = gxsp_find_face(layout->nodes[e], face, corners);
        if (other == 4) return 0;
        order[i][moving] = (uint8_t)other;
        order[i][0] = corners[0], order[i][1] = corners[1], order[i][5 - moving] = corners[2];
        strip[i] = (uint16_t)e;
    }
    return 1;
}

/* A strip of length elements that begins with e, which has no lane yet. Returns whether there is one. */
static int gxsp_find_strip(const gxsp_layout *layout, uint32_t e, uint32_t length, uint16_t *strip,
                           uint8_t (*order)[4]) {
    static const uint8_t edges[6][4] = {{0, 1, 2, 3}, {0, 2, 1, 3}, {0, 3, 1, 2},
                                        {1, 2, 0, 3}, {1, 3, 0, 2}, {2, 3, 0, 1}};
    int edge, swapped;
    for (edge = 0; edge < 6; edge++)
        for (swapped = 0; swapped < 2; swapped++) {
            strip[0] = (uint16_t)e;
            memcpy(order[0], edges[edge], 4);
            order[0][2] = edges[edge][2 + swapped], order[0][3] = edges[edge][3 - swapped];
            if (gxsp_walk_strip(layout, length, strip, order)) return 1;
        }
    return 0;
}

/* Lists strips of length elements that have no lane yet. Returns how many strips there are. */
static uint32_t gxsp_list_strips(gxsp_layout *layout, uint32_t length) {
    uint32_t e, i, found = 0;
    for (e = 0; e < layout->count; e++)
        if (!layout->placed[e] &&
            gxsp_find_strip(layout, e, length, &layout->strip[found * length], &layout->turn[found * length])) {
            for (i = 0; i < length; i++) layout->placed[layout->strip[found * length + i]] = 1;
            found++;
        }
    return found;
}

/* Puts strips of length elements side by side into the blocks from first on, one strip per lane. Single elements
 * all get a lane; of longer strips those that fill whole blocks. Returns the first block that is left. */
static uint32_t gxsp_place_strips(gxsp_layout *layout, uint32_t blocks, uint32_t length, uint32_t first) {
    const uint32_t strips = gxsp_list_strips(layout, length), rows = length > 1 ? strips / GXSP_LANES : blocks - first;
    uint32_t c, i;
    for (c = 0; c < strips; c++)
        for (i = 0; i < length; i++) {
            const uint32_t index = c * length + i, e = layout->strip[index];
            const uint32_t lane = c < rows * GXSP_LANES ? (first + c % rows * length + i) * GXSP_LANES + c / rows : 0;
            layout->placed[e] = c < rows * GXSP_LANES;
            if (!layout->placed[e]) continue;
            layout->element[lane] = (uint16_t)e;
            memcpy(layout->order[lane], layout->turn[index], 4);
        }
    return first + rows * length;
}

/* The lane of each element of a chunk. nodes: of the elements; neighbours follow each other */
static GXSP_APART void gxsp_assign_lanes(gxsp_layout *layout, uint32_t (*nodes)[4], uint32_t count, uint32_t blocks) {
    uint32_t lane, length, first = 0;
    layout->nodes = nodes;
    layout->count = count;
    memset(layout->placed, 0, sizeof layout->placed);
    for (lane = 0; lane < GXSP_CHUNK; lane++) layout->element[lane] = (uint16_t)count;
    gxsp_find_across(layout);
    for (length = GXSP_STRIP; length > 0; length /= 2) first = gxsp_place_strips(layout, blocks, length, first);
}

/* >>chunks: blocks and slots --------------------------------------------------------------------------------------- */

/* In: the sorted elements. Out: chunks with their blocks and nodes, and the slots of every copy. Writes
 * gxsp_mesh. */

static const gxsp_moments *gxsp_block_moments(const gxsp_chunk *chunk, uint32_t block) {
    return chunk->moments ? &chunk->moments[block] : NULL;
}

static gxsp_general *gxsp_block_general(const gxsp_chunk *chunk, uint32_t block) {
    return chunk->generals ? &chunk->generals[block] : NULL;
}

static void gxsp_lane_copies(const gxsp_system *system, const gxsp_chunk *chunk, uint32_t block, int lane,
                             uint32_t *copies) {
    const gxsp_corners *corner = &chunk->corners[block];
    int i;
    for (i = 0; i < 4; i++) copies[i] = system->mesh.nodes[chunk->first_node + corner->node[i][lane]];
}

/* Row sum of the mass of a lane's element at corner k */
static double gxsp_lane_mass(const gxsp_chunk *chunk, uint32_t lane, int k) {
    const size_t b = lane / GXSP_LANES, l = lane % GXSP_LANES;
    const gxsp_moments *moments = gxsp_block_moments(chunk, (uint32_t)b);
    return chunk->rest[b].mass[l] *
           (!moments ? 5
                     : (double)(k > 0 ? moments->centre[k - 1][l]
                                      : 1 - (moments->centre[0][l] + moments->centre[1][l] + moments->centre[2][l])));
}

/* Does the element of a lane give corner k stiffness or mass? */
static int gxsp_lane_supports(const gxsp_chunk *chunk, uint32_t lane, int k) {
    return chunk->rest[lane / GXSP_LANES].weight[lane % GXSP_LANES] > 0 || gxsp_lane_mass(chunk, lane, k) > 0;
}

/* Puts elements of a chunk into their lanes. elements: sorted; nodes: theirs, numbered in the chunk */
static GXSP_APART void gxsp_fill_chunk(const gxsp_chunk *chunk, const gxs_model *model, const gxsp_sorted *elements,
                                       uint32_t (*nodes)[4], uint32_t count) {
    gxsp_layout layout;
    uint32_t placed[GXSP_CHUNK][4], lane;
    int k;
    gxsp_assign_lanes(&layout, nodes, count, chunk->block_count);
    memset(placed, 0xff, sizeof placed);
    for (lane = 0; lane < chunk->block_count * GXSP_LANES; lane++) {
        const uint32_t e = layout.element[lane];
        if (e == count) { /* no weight, but a valid material */
            chunk->rest[lane / GXSP_LANES].material[lane % GXSP_LANES] = model->elements[elements[0].index].material;
            continue;
        }
        gxsp_place_element(chunk, &model->elements[elements[e].index], layout.order[lane], lane, model->lumped_mass);
        for (k = 0; k < 4; k++) placed[lane][k] = nodes[e][layout.order[lane][k]];
    }
    gxsp_set_corners(chunk, placed);
}

/* Blocks and nodes of all chunks */
static void gxsp_fill_chunks(gxsp_system *system, const gxs_model *model, const gxsp_sorted *sorted,
                             gxsp_numbers *numbers) {
    uint32_t copies[GXSP_CHUNK][4], c;
    size_t first = 0;
    for (c = 0; c < system->mesh.chunk_count; c++) {
        gxsp_chunk *chunk = &system->mesh.chunks[c];
        uint32_t e;
        for (e = 0; first + e < model->element_count && e < chunk->block_count * GXSP_LANES &&
                    sorted[first + e].class_index == chunk->class_index;
             e++) {
            const gxs_element *element = &model->elements[sorted[first + e].index];
            gxsp_prefetch(element, sizeof *element);
            memcpy(copies[e], element->copy, sizeof copies[e]);
        }
        chunk->first_node = (uint32_t)system->mesh.slot_count;
        chunk->node_count = gxsp_number_nodes(copies, e, numbers, system->mesh.nodes + system->mesh.slot_count);
        gxsp_fill_chunk(chunk, model, sorted + first, copies, e);
        first += e;
        system->mesh.slot_count += chunk->node_count;
    }
}

/* Cuts the sorted elements into chunks: their blocks and classes. Returns the number of chunks. chunks: NULL, or
 * room for all */
static uint32_t gxsp_plan_chunks(gxsp_system *system, const gxsp_sorted *sorted, gxsp_chunk *chunks) {
    uint32_t chunk_count = 0;
    size_t i = 0;
    system->mesh.block_count = 0;
    while (i < system->model.element_count) {
        uint32_t class_index = sorted[i].class_index, count = 0;
        gxsp_chunk chunk;
        memset(&chunk, 0, sizeof chunk);
        while (i < system->model.element_count && sorted[i].class_index == class_index && count < GXSP_CHUNK)
            i++, count++;
        chunk.class_index = class_index;
        chunk.kind = (gxs_material_kind)(class_index / 4);
        chunk.first_block = (uint32_t)system->mesh.block_count;
        chunk.block_count = (count + GXSP_LANES - 1) / GXSP_LANES;
        system->mesh.block_count += chunk.block_count;
        if (chunks) chunks[chunk_count] = chunk;
        chunk_count++;
    }
    return chunk_count;
}

/* Blocks of the planned chunks, without those that linearisations write */
static void gxsp_blocks_make(gxsp_pool *pool, gxsp_chunk *chunks, uint32_t count) {
    gxsp_rest *rest;
    gxsp_corners *corners;
    gxsp_gradients *gradients;
    gxsp_moments *moments;
    uint32_t *groups;
    uint8_t *changed;
    size_t blocks = 0, own = 0, general = 0;
    uint32_t c;
    for (c = 0; c < count; c++) {
        blocks += chunks[c].block_count;
        own += chunks[c].class_index & 2 ? chunks[c].block_count : 0;
        general += chunks[c].class_index & 1 ? chunks[c].block_count : 0;
    }
    rest = (gxsp_rest *)gxsp_take(pool, blocks, sizeof(gxsp_rest));
    corners = (gxsp_corners *)gxsp_take(pool, blocks, sizeof(gxsp_corners));
    groups = (uint32_t *)gxsp_take(pool, blocks * GXSP_LANES, sizeof(uint32_t));
    gradients = (gxsp_gradients *)gxsp_take(pool, own, sizeof(gxsp_gradients));
    moments = (gxsp_moments *)gxsp_take(pool, general, sizeof(gxsp_moments));
    changed = (uint8_t *)gxsp_take(pool, blocks + count, 1);
    if (pool->failed) return;
    memset(groups, 0xff, blocks * GXSP_LANES * sizeof *groups);
    for (c = 0; c < count; c++) {
        chunks[c].rest = rest;
        chunks[c].corners = corners;
        chunks[c].groups = groups;
        chunks[c].changed = changed;
        chunks[c].gradients = chunks[c].class_index & 2 ? gradients : NULL;
        chunks[c].moments = chunks[c].class_index & 1 ? moments : NULL;
        rest += chunks[c].block_count;
        corners += chunks[c].block_count;
        groups += chunks[c].block_count * GXSP_LANES;
        changed += chunks[c].block_count + 1;
        gradients += chunks[c].class_index & 2 ? chunks[c].block_count : 0;
        moments += chunks[c].class_index & 1 ? chunks[c].block_count : 0;
    }
}

/* Blocks that linearisations write */
static void gxsp_tangents_make(gxsp_pool *pool, gxsp_chunk *chunks, uint32_t count) {
    gxsp_tangent *tangents;
    gxsp_general *generals;
    size_t blocks = 0, custom = 0;
    uint32_t c;
    for (c = 0; c < count; c++) {
        blocks += chunks[c].block_count;
        custom += chunks[c].kind == GXS_CUSTOM ? chunks[c].block_count : 0;
    }
    tangents = (gxsp_tangent *)gxsp_take(pool, blocks, sizeof(gxsp_tangent));
    generals = (gxsp_general *)gxsp_take(pool, custom, sizeof(gxsp_general));
    for (c = 0; c < count && !pool->failed; c++) {
        chunks[c].tangents = tangents;
        chunks[c].generals = chunks[c].kind == GXS_CUSTOM ? generals : NULL;
        tangents += chunks[c].block_count;
        generals += chunks[c].kind == GXS_CUSTOM ? chunks[c].block_count : 0;
    }
}

/* The slots of every copy, in the order of chunks */
static void gxsp_list_slots(gxsp_system *system) {
    uint32_t i;
    size_t s;
    memset(system->mesh.copy_start, 0, (system->model.n + 2) * sizeof *system->mesh.copy_start);
    for (s = 0; s < system->mesh.slot_count; s++) system->mesh.copy_start[system->mesh.nodes[s] + 2]++;
    for (i = 0; i < system->model.n; i++) system->mesh.copy_start[i + 2] += system->mesh.copy_start[i + 1];
    for (s = 0; s < system->mesh.slot_count; s++) /* slots follow the order of chunks */
        system->mesh.copy_slot[system->mesh.copy_start[system->mesh.nodes[s] + 1]++] = (uint32_t)s;
    memset(system->mesh.copy_slot + system->mesh.slot_count, 0, GXSP_AHEAD * sizeof *system->mesh.copy_slot);
    memset(system->mesh.nodes + system->mesh.slot_count, 0, GXSP_AHEAD * sizeof *system->mesh.nodes);
}

static void gxsp_chunks_make(gxsp_system *system, gxsp_pool *scratch, const gxs_model *model) {
    gxsp_sorted *sorted = gxsp_order_elements(system, model, scratch);
    gxsp_numbers numbers;
    uint32_t *nodes;
    numbers.local = (uint32_t *)gxsp_take(scratch, system->model.n, sizeof(uint32_t));
    numbers.stamp = (uint32_t *)gxsp_take(scratch, system->model.n, sizeof(uint32_t));
    numbers.round = 0;
    if (scratch->failed) return;
    system->mesh.chunk_count = gxsp_plan_chunks(system, sorted, NULL);
    system->mesh.chunk_room = system->mesh.chunk_count;
    gxsp_columns_make(system, GXSP_COLUMNS(gxsp_chunk_columns), GXSP_WITH_MODEL, system->mesh.chunk_count);
    /* the number of slots is not known yet */
    system->mesh.nodes = (uint32_t *)gxsp_take(scratch, 4 * system->model.element_count, sizeof(uint32_t));
    if (scratch->failed || system->pool.failed) return;
    (void)gxsp_plan_chunks(system, sorted, system->mesh.chunks);
    gxsp_blocks_make(&system->pool, system->mesh.chunks, system->mesh.chunk_count);
    if (system->pool.failed) return;
    gxsp_fill_chunks(system, model, sorted, &numbers);
    system->mesh.copy_slot =
        (uint32_t *)gxsp_take(&system->pool, system->mesh.slot_count + GXSP_AHEAD, sizeof(uint32_t));
    nodes = (uint32_t *)gxsp_take(&system->pool, system->mesh.slot_count + GXSP_AHEAD, sizeof(uint32_t));
    if (system->pool.failed) return;
    memcpy(nodes, system->mesh.nodes, system->mesh.slot_count * sizeof(uint32_t));
    system->mesh.nodes = nodes;
    gxsp_list_slots(system);
}

/* >>affine: elements with affine copies ---------------------------------------------------------------------------- */

/* In: gxs_model.affine. Out: groups, and the elements with an affine corner in blocks of their own: chunks do not have
 * them. Where no copy is affine, nothing here is made. */

/* Edges of an element: pairs of its corners */
static const uint8_t gxsp_edge_ends[6][2] = {{0, 1}, {0, 2}, {0, 3}, {1, 2}, {1, 3}, {2, 3}};

static int gxsp_is_affine(const gxs_model *model, const gxs_element *element) {
    int k;
    for (k = 0; k < 4 && model->affine; k++)
        if (model->affine[element->copy[k]] != GXS_NOT_AFFINE) return 1;
    return 0;
}

/* Is the mass that of each copy's row, for the model or for the step at work? */
static inline int gxsp_is_lumped(const gxsp_system *system) { return system->model.lumped_mass || system->state.quick; }

/* Is a vector one of the hidden ones of an affine copy? A translation does not move those. affine: NULL: none is */
static inline int gxsp_hides(const gxsp_affine *affine, size_t vector) {
    const uint32_t *place = affine ? affine->place : NULL;
    return place && place[vector] != GXSP_NONE && (place[vector] & 3) > 0;
}

static inline int gxsp_is_hidden(const gxsp_system *system, size_t copy) { return gxsp_hides(&system->affine, copy); }

static inline int gxsp_is_grouped(const gxsp_system *system, size_t copy) {
    return system->affine.place && system->affine.place[copy] != GXSP_NONE;
}

/* Room for so many groups. What they had is lost. */
static void gxsp_groups_room(gxsp_system *system, uint32_t count) {
    gxsp_affine *affine = &system->affine;
    if (count <= affine->group_room) return;
    affine->group_room = affine->group_room > 0 ? (uint32_t)gxsp_room(count) : count;
    affine->member =
        (uint32_t(*)[4])gxsp_grow(&system->pool, affine->member, 0, affine->group_room, sizeof *affine->member);
    affine->full =
        (double(*)[10][9])gxsp_grow(&system->pool, affine->full, 0, affine->group_room, sizeof *affine->full);
    affine->root = (float(*)[78])gxsp_grow(&system->pool, affine->root, 0, affine->group_room, sizeof *affine->root);
}

static uint32_t gxsp_count_groups(const uint32_t *affine, size_t copies) {
    uint32_t count = 0;
    size_t i;
    for (i = 0; i < copies; i++) count += affine[i] != GXS_NOT_AFFINE;
    return count;
}

/* Groups; there is room. Hidden vectors take over the rest position of their copy. first: n, as gxs_model.affine */
static void gxsp_groups_make(gxsp_system *system, const uint32_t *first) {
    gxsp_affine *affine = &system->affine;
    size_t i, k;
    uint32_t group = 0;
    memset(affine->place, 0xff, system->model.n * sizeof *affine->place);
    for (i = 0; i < system->model.n; i++) {
        if (first[i] == GXS_NOT_AFFINE) continue;
        for (k = 0; k < 4; k++) {
            const uint32_t vector = k == 0 ? (uint32_t)i : first[i] + (uint32_t)k - 1;
            affine->member[group][k] = vector;
            affine->place[vector] = 4 * group + (uint32_t)k;
            if (k > 0 && system->model.positions)
                memcpy(system->model.positions + 3 * (size_t)vector, system->model.positions + 3 * i,
                       3 * sizeof(double));
        }
        group++;
    }
    affine->group_count = group;
}

/* The groups of a new model */
static void gxsp_groups_begin(gxsp_system *system, const gxs_model *model) {
    const uint32_t count = gxsp_count_groups(model->affine, system->model.n);
    if (count == 0) return;
    system->affine.length = model->affine_length;
    system->affine.place = (uint32_t *)gxsp_take(&system->pool, system->model.n, sizeof(uint32_t));
    gxsp_groups_room(system, count);
    if (!system->pool.failed) gxsp_groups_make(system, model->affine);
}

/* Shape functions at the four points of an element: x_p = c + L t_p, with L L^T the covariance of its mass. They
 * integrate every quadratic exactly, with equal weights. Two points are in the middle of a sheet, one above, one below
 * where the two others are not: products of its bend with squares along it, which large rotations make, then have the
 * mean 0 as they should. Other rotations of t make it softer one way than the other. shape: [p][i] */
static void gxsp_four_points(const gxs_element *element, double shape[4][4]) {
    static const double root2 = 1.4142135623730951;
    const double at[4][3] = {{1, 0, root2}, {1, 0, -root2}, {-1, root2, 0}, {-1, -root2, 0}};
    static const double whole[10] = {2, 1, 1, 1, 2, 1, 1, 2, 1, 2};
    double centre[4], rounded[4], covariance[3][3], root[3][3];
    const double *mass = element->mass;
    double sum = gxsp_find_centre(mass, centre, rounded);
    int i, j, p;
    if (!(sum > 0)) sum = gxsp_find_centre(mass = whole, centre, rounded); /* no mass, but stiffness */
    for (i = 0; i < 3; i++)
        for (j = 0; j < 3; j++)
            covariance[i][j] = mass[gxsp_packed_mass[i + 1][j + 1]] / sum - centre[i + 1] * centre[j + 1];
    gxsp_factor3(covariance, root);
    for (p = 0; p < 4; p++) {
        shape[p][0] = 1;
        for (i = 0; i < 3; i++) {
            shape[p][i + 1] = centre[i + 1] + at[p][0] * root[i][0] + at[p][1] * root[i][1] + at[p][2] * root[i][2];
            shape[p][0] -= shape[p][i + 1];
        }
    }
}

/* X_j - X_0 of corners 1 ... 3, from the gradients. 0: the element has no volume */
static int gxsp_element_edges(const gxs_element *element, double edge[3][3]) {
    double determinant = 0;
    int i, k, finite = 1;
    for (i = 0; i < 3; i++) {
        const double *a = element->gradient[1 + (i + 1) % 3], *b = element->gradient[1 + (i + 2) % 3];
        edge[i][0] = a[1] * b[2] - a[2] * b[1], edge[i][1] = a[2] * b[0] - a[0] * b[2],
        edge[i][2] = a[0] * b[1] - a[1] * b[0];
    }
    for (k = 0; k < 3; k++) determinant += element->gradient[1][k] * edge[0][k];
    if (!(fabs(determinant) >= DBL_MIN)) return 0;
    for (k = 0; k < 9; k++) {
        edge[k / 3][k % 3] /= determinant;
        finite &= gxsp_finite(edge[k / 3][k % 3]);
    }
    return finite;
}

static void gxsp_affine_fill(gxsp_system *system, const gxs_element *element, gxsp_affine_block *block, int l) {
    double edge[3][3], shape[4][4], rows[4];
    int i, k;
    if (!gxsp_element_edges(element, edge)) memset(edge, 0, sizeof edge); /* then it has no weight */
    gxsp_four_points(element, shape);
    for (k = 0; k < 9; k++) {
        block->edge[k][l] = edge[k / 3][k % 3] / (4 * system->affine.length);
        block->gradient[k][l] = element->gradient[1 + k / 3][k % 3];
    }
    for (k = 0; k < 16; k++) block->shape[k / 4][k % 4][l] = shape[k / 4][k % 4];
    block->rest.weight[l] = 0.25 * element->weight;
    block->rest.mass[l] = 0.25 * gxsp_find_centre(element->mass, rows, shape[0]);
    block->rest.material[l] = element->material;
    for (i = 0; i < 4; i++) {
        const uint32_t copy = element->copy[i], place = system->affine.place[copy];
        block->vector[i][l] = copy;
        for (k = 0; k < 3; k++)
            block->vector[4 + 3 * i + k][l] = place == GXSP_NONE ? GXSP_NONE : system->affine.member[place / 4][k + 1];
    }
}

/* Row sum of the mass of a lane's element at corner k: the four points have equal weights */
static double gxsp_affine_mass(const gxsp_affine_block *block, int l, int k) {
    return block->rest.mass[l] *
           (block->shape[0][k][l] + block->shape[1][k][l] + block->shape[2][k][l] + block->shape[3][k][l]);
}

/* Row sums of the mass at hidden vectors, int rho N_i (x - X_i) / length: gravity acts on them by these. touched: those
 * of these copies; NULL: all */
static void gxsp_affine_lump(gxsp_system *system, const gxsp_affine_block *block, int l, const uint8_t *touched) {
    int i, j, k, p;
    for (i = 0; i < 4; i++)
        for (k = 0; k < 3 && block->vector[4 + 3 * i][l] != GXSP_NONE && (!touched || touched[block->vector[i][l]]);
             k++) {
            double sum = 0;
            for (p = 0; p < 4; p++) {
                double way = 0; /* (x - X_i) / (4 length) at the point */
                for (j = 0; j < 4; j++)
                    way += block->shape[p][j][l] * ((j > 0 ? block->edge[3 * (j - 1) + k][l] : 0) -
                                                    (i > 0 ? block->edge[3 * (i - 1) + k][l] : 0));
                sum += 4 * block->rest.mass[l] * block->shape[p][i][l] * way;
            }
            system->model.lumped[block->vector[4 + 3 * i + k][l]] += sum;
        }
}

/* A block without elements; there is room */
static gxsp_affine_block *gxsp_affine_open(gxsp_system *system, uint32_t b, gxs_material_kind kind) {
    gxsp_affine_block *block = &system->affine.blocks[b];
    memset(block, 0, sizeof *block);
    block->kind = kind;
    memset(block->vector, 0xff, sizeof block->vector);
    memset(system->affine.groups + (size_t)b * GXSP_LANES, 0xff, GXSP_LANES * sizeof(uint32_t));
    if (kind == GXS_CUSTOM) block->general = (gxsp_general *)gxsp_take(&system->pool, 4, sizeof(gxsp_general));
    return block;
}

/* Blocks of the elements: those of one kind together. order: elements of each kind, in the caller's order */
static void gxsp_affine_blocks(gxsp_system *system, const gxs_model *model, const uint32_t *elements) {
    gxsp_affine *affine = &system->affine;
    uint32_t e, first, b = 0, count[GXS_CUSTOM + 1] = {0, 0, 0, 0, 0};
    int kind, l, k;
    for (e = 0; e < affine->count; e++) count[model->materials[model->elements[elements[e]].material].kind]++;
    for (kind = 0; kind <= GXS_CUSTOM; kind++) affine->block_count += (count[kind] + GXSP_LANES - 1) / GXSP_LANES;
    affine->block_room = affine->block_count;
    affine->blocks = (gxsp_affine_block *)gxsp_take(&system->pool, affine->block_count, sizeof *affine->blocks);
    affine->groups = (uint32_t *)gxsp_take(&system->pool, (size_t)affine->block_count * GXSP_LANES, sizeof(uint32_t));
    for (kind = 0; kind <= GXS_CUSTOM && !system->pool.failed; kind++)
        for (e = first = 0; first < count[kind]; b++) {
            gxsp_affine_block *block = gxsp_affine_open(system, b, (gxs_material_kind)kind);
            for (l = 0; l < GXSP_LANES && first < count[kind]; l++, first++, e++) {
                while ((int)model->materials[model->elements[elements[e]].material].kind != kind) e++;
                affine->groups[(size_t)b * GXSP_LANES + (size_t)l] = model->elements[elements[e]].group;
                gxsp_affine_fill(system, &model->elements[elements[e]], block, l);
                gxsp_affine_lump(system, block, l, NULL);
            }
            for (k = l; k < GXSP_LANES; k++) /* a valid material of this kind */
                block->rest.material[k] = block->rest.material[0];
        }
}

/* Memory for results of a round of blocks */
static void gxsp_affine_results(gxsp_system *system) {
    gxsp_affine *affine = &system->affine;
    const uint32_t blocks = affine->block_count < GXSP_AFFINE_ROUND ? affine->block_count : GXSP_AFFINE_ROUND;
    if (blocks <= affine->slot_blocks) return;
    affine->slots = (double(*)[3])gxsp_grow(&system->pool, affine->slots, 0, (size_t)blocks * 16 * GXSP_LANES,
                                            sizeof *affine->slots);
    affine->slot_blocks = blocks;
}

/* Divides the model's elements: those with an affine corner come here, `plain` gets the others. Both lists are in
 * scratch. */
static void gxsp_affine_make(gxsp_system *system, gxsp_pool *scratch, const gxs_model *model, gxs_model *plain) {
    gxs_element *others;
    uint32_t *elements;
    size_t e, count = 0;
    for (e = 0; e < model->element_count; e++)
        system->affine.count += (size_t)gxsp_is_affine(model, &model->elements[e]);
    if (system->affine.count == 0) { /* no element has them: they are copies without support */
        system->affine.place = NULL;
        system->affine.group_count = 0;
        return;
    }
    others = (gxs_element *)gxsp_take(scratch, model->element_count - system->affine.count, sizeof *others);
    elements = (uint32_t *)gxsp_take(scratch, system->affine.count, sizeof(uint32_t));
    if (scratch->failed) return;
    for (e = 0; e < model->element_count; e++)
        if (gxsp_is_affine(model, &model->elements[e]))
            elements[e - count] = (uint32_t)e;
        else
            others[count++] = model->elements[e];
    plain->elements = others;
    plain->element_count = system->model.element_count = count;
    gxsp_affine_blocks(system, model, elements);
    gxsp_affine_results(system);
    system->affine.sum = (double(*)[3])gxsp_take(&system->pool, system->model.n, sizeof *system->affine.sum);
    system->affine.own = (double(*)[6])gxsp_take(&system->pool, system->model.n, sizeof *system->affine.own);
}

/* Joins the vectors of a group. forest: n */
static void gxsp_join_groups(const gxsp_system *system, uint32_t *forest) {
    uint32_t group, k;
    for (group = 0; group < system->affine.group_count; group++)
        for (k = 1; k < 4; k++) gxsp_join(forest, system->affine.member[group][0], system->affine.member[group][k]);
}

/* Marks the blocks whose vectors are all still. */
static void gxsp_mark_still_blocks(gxsp_system *system) {
    uint32_t b, k;
    for (b = 0; b < system->affine.block_count; b++) {
        gxsp_affine_block *block = &system->affine.blocks[b];
        block->still = 1;
        for (k = 0; k < 16 * GXSP_LANES; k++) {
            const uint32_t vector = block->vector[k / GXSP_LANES][k % GXSP_LANES];
            block->still &= vector == GXSP_NONE || system->state.still[vector];
        }
    }
}

/* >>copies: which copies move, which follow others, which belong together ------------------------------------------ */

/* In: held copies, constraints and elements. Out: fixed copies, followers, components and the partial sums of
 * chunks. Writes gxsp_model; marks in gxsp_history what a step leaves alone. */

/* Columns over copies that come with the model. positions: as given, or NULL */
static void gxsp_copies_make(gxsp_system *system, const double *positions) {
    const size_t n = system->model.copy_room = system->model.n;
    if (positions) system->model.positions = (double *)gxsp_take(&system->pool, n, 3 * sizeof(double));
    if (system->model.positions) memcpy(system->model.positions, positions, 3 * n * sizeof(double));
    gxsp_columns_make(system, GXSP_COLUMNS(gxsp_copy_columns), GXSP_WITH_MODEL, n);
}

/* Row sums of the mass. Copies that no element supports are fixed, like held ones. */
static void gxsp_find_fixed(gxsp_system *system, const gxs_model *model) {
    size_t e, i;
    int k;
    memset(system->model.fixed, 1, system->model.n);
    for (e = 0; e < model->element_count; e++) {
        const gxs_element *element = &model->elements[e];
        double rows[4];
        gxsp_row_masses(element, rows);
        for (k = 0; k < 4; k++) {
            if (gxsp_supports(element, k)) system->model.fixed[element->copy[k]] = 0;
            system->model.lumped[element->copy[k]] += rows[k];
        }
    }
    for (i = 0; i < system->model.n; i++)
        if (gxsp_is_hidden(system, i))
            system->model.fixed[i] = system->model.fixed[system->affine.member[system->affine.place[i] / 4][0]];
    if (model->held)
        for (i = 0; i < system->model.n; i++)
            if (model->held[i]) system->model.held[i] = system->model.fixed[i] = 1;
}

static inline int gxsp_follows(const gxsp_system *system, size_t copy) {
    return system->model.follower_count > 0 && system->model.follower[copy] != GXSP_NONE;
}

/* Index of a constraint that is not allowed: its copy has two, or a master follows others. SIZE_MAX: all are
 * allowed. held: n flags or NULL; follows: n zeros, scratch */
static size_t gxsp_bad_constraint(const gxs_constraint *constraints, size_t count, const uint8_t *held,
                                  uint8_t *follows) {
    size_t i;
    int k;
    for (i = 0; i < count; i++) {
        if (held && held[constraints[i].copy]) continue;
        if (follows[constraints[i].copy]) return i;
        follows[constraints[i].copy] = 1;
    }
    for (i = 0; i < count; i++)
        for (k = 0; k < 4 && !(held && held[constraints[i].copy]); k++)
            if (fabs(constraints[i].weight[k]) > 0 && follows[constraints[i].master[k]]) return i;
    return SIZE_MAX;
}

/* Room for the followers of so many constraints, and for the copies that there are */
static void gxsp_followers_room(gxsp_system *system, size_t count) {
    gxsp_model *model = &system->model;
    if (system->affine.group_count > 0) count *= 4;
    if (count > model->follower_room) {
        model->follower_room = (uint32_t)gxsp_room(count);
        model->followers =
            (gxsp_follower *)gxsp_grow(&system->pool, model->followers, 0, model->follower_room, sizeof(gxsp_follower));
    }
    if (count > 0 && !model->follower)
        model->follower = (uint32_t *)gxsp_take(&system->pool, model->copy_room, sizeof(uint32_t));
}

/* Makes a vector follow those of a constraint, and returns the follower. */
static gxsp_follower *gxsp_add_follower(gxsp_system *system, uint32_t vector, const gxs_constraint *constraint) {
    gxsp_follower *follower = &system->model.followers[system->model.follower_count];
    follower->copy = vector;
    follower->count = 4;
    memcpy(follower->master, constraint->master, sizeof constraint->master);
    memcpy(follower->weight, constraint->weight, sizeof constraint->weight);
    system->model.fixed[vector] = 0;
    system->model.follower[vector] = system->model.follower_count++;
    return follower;
}

/* An affine copy i follows the field of its masters k, a_i = sum w_k (a_k + A_k (X_i - X_k)), A_i = sum w_k A_k, so it
 * bends as they do. follower: that of a_i, with sum w_k a_k */
static void gxsp_follow_field(gxsp_system *system, gxsp_follower *follower, const gxs_constraint *constraint) {
    const gxsp_affine *affine = &system->affine;
    const double *x = system->model.positions + 3 * (size_t)constraint->copy;
    gxs_constraint column = *constraint; /* of A_i */
    uint32_t a, k;
    for (k = 0; k < 4; k++)
        for (a = 0; a < 3 && affine->place[constraint->master[k]] != GXSP_NONE; a++) {
            const double *from = system->model.positions + 3 * (size_t)constraint->master[k];
            if (!(fabs(constraint->weight[k]) > 0)) continue;
            follower->master[follower->count] = affine->member[affine->place[constraint->master[k]] / 4][a + 1];
            follower->weight[follower->count++] = constraint->weight[k] * (x[a] - from[a]) / affine->length;
        }
    for (a = 1; a < 4; a++) {
        for (k = 0; k < 4; k++)
            if (affine->place[constraint->master[k]] != GXSP_NONE)
                column.master[k] = affine->member[affine->place[constraint->master[k]] / 4][a];
            else
                column.weight[k] = 0;
        (void)gxsp_add_follower(system, affine->member[affine->place[constraint->copy] / 4][a], &column);
    }
}

/* Sets the followers. None of them is fixed unless it is held. */
static void gxsp_set_followers(gxsp_system *system, const gxs_constraint *constraints, size_t count) {
    size_t i;
    gxsp_followers_room(system, count);
    system->model.follower_count = 0;
    if (system->pool.failed || count == 0) return;
    memset(system->model.follower, 0xff, system->model.n * sizeof *system->model.follower);
    for (i = 0; i < count; i++) {
        gxsp_follower *follower;
        if (system->model.held[constraints[i].copy]) continue;
        follower = gxsp_add_follower(system, constraints[i].copy, &constraints[i]);
        if (system->affine.place && system->affine.place[follower->copy] != GXSP_NONE)
            gxsp_follow_field(system, follower, &constraints[i]);
    }
}

/* Joins copies that constraints couple. forest: n */
static void gxsp_join_followers(const gxsp_system *system, uint32_t *forest) {
    size_t i;
    uint32_t k;
    for (i = 0; i < system->model.follower_count; i++)
        for (k = 0; k < system->model.followers[i].count; k++)
            if (fabs(system->model.followers[i].weight[k]) > 0)
                gxsp_join(forest, system->model.followers[i].copy, system->model.followers[i].master[k]);
}

/* Joins copies that elements and constraints couple. forest: n */
static void gxsp_join_copies(const gxsp_system *system, const gxs_model *model, uint32_t *forest) {
    size_t e, i;
    int k;
    for (i = 0; i < system->model.n; i++) forest[i] = (uint32_t)i;
    for (e = 0; e < model->element_count; e++)
        for (k = 1; k < 4; k++)
            if (gxsp_supports(&model->elements[e], 0) || gxsp_supports(&model->elements[e], k))
                gxsp_join(forest, model->elements[e].copy[0], model->elements[e].copy[k]);
    gxsp_join_groups(system, forest);
    gxsp_join_followers(system, forest);
}

/* Numbers the components: the trees of a forest of copies */
static void gxsp_number_components(gxsp_system *system, uint32_t *forest) {
    size_t i;
    system->model.component_count = 0;
    for (i = 0; i < system->model.n; i++) { /* roots come before their copies: the lower index wins in gxsp_join */
        uint32_t root = gxsp_root(forest, (uint32_t)i);
        system->model.component[i] = root == i ? system->model.component_count++ : system->model.component[root];
    }
}

/* Masses and states of the components, which are zero before. A translation of a component of state 0 meets no
 * stiffness: K T = 0, so T^T (K + rate M) x = rate x sum of lumped x. */
static void gxsp_fill_components(gxsp_system *system) {
    size_t i;
    uint32_t p;
    for (i = 0; i < system->model.n; i++) {
        gxsp_component *component = &system->model.components[system->model.component[i]];
        component->mass += gxsp_is_hidden(system, i) ? 0 : system->model.lumped[i];
        component->state |= system->model.fixed[i] ? GXSP_HELD : 0;
        component->movers += !system->model.fixed[i] && !gxsp_is_hidden(system, i);
    }
    for (i = 0; i < system->model.follower_count; i++) {
        const double *w = system->model.followers[i].weight;
        const uint32_t copy = system->model.followers[i].copy;
        gxsp_component *component = &system->model.components[system->model.component[copy]];
        if (gxsp_is_hidden(system, copy)) continue;
        if (fabs(w[0] + w[1] + w[2] + w[3] - 1) > 1e-12) component->state |= GXSP_UNBALANCED;
        component->movers -= !system->model.fixed[copy];
    }
    for (p = 0; p < system->model.component_count; p++)
        system->model.components[p].state |= system->model.components[p].mass > 0 ? 0 : GXSP_UNBALANCED;
}

/* Does a copy have no part in coarse levels? Held ones have none, nor have those of a component that moves as one of
 * its copies does: the smoother solves for that one, and coarse functions around it would all be the same. */
static int gxsp_is_left_out(const gxsp_system *system, size_t copy) {
    return system->model.fixed[copy] || system->model.components[system->model.component[copy]].movers <= 1;
}

/* The components of every chunk, ascending. partials: NULL, or room for all. Returns how many there are. */
static uint32_t gxsp_list_partials(gxsp_system *system, gxsp_partial *partials) {
    uint32_t c, k, count = 0;
    for (c = 0; c < system->model.component_count; c++)
        system->model.components[c].lead = GXSP_NONE; /* in this loop: the last chunk that has met it */
    for (c = 0; c < system->mesh.chunk_count; c++) {
        gxsp_chunk *chunk = &system->mesh.chunks[c];
        chunk->first_partial = count;
        for (k = 0; k < chunk->node_count; k++) {
            const uint32_t component = system->model.component[system->mesh.nodes[chunk->first_node + k]];
            uint32_t place = count;
            if (system->model.components[component].lead == c) continue;
            system->model.components[component].lead = c;
            for (; partials && place > chunk->first_partial && partials[place - 1].component > component; place--)
                partials[place].component = partials[place - 1].component;
            if (partials) partials[place].component = component;
            count++;
        }
        chunk->partial_count = count - chunk->first_partial;
    }
    for (c = 0; c < system->model.component_count; c++) system->model.components[c].lead = c;
    return count;
}

/* Partial sums of the chunks, in place of those before */
static void gxsp_partials_make(gxsp_system *system) {
    const uint32_t count = gxsp_list_partials(system, NULL);
    system->mesh.partials =
        (gxsp_partial *)gxsp_grow(&system->pool, system->mesh.partials, 0, count, sizeof(gxsp_partial));
    system->mesh.partial_count = count;
    if (!system->pool.failed) (void)gxsp_list_partials(system, system->mesh.partials);
}

/* The component that leads a copy's component */
static gxsp_component *gxsp_lead_of(const gxsp_system *system, size_t copy) {
    return &system->model.components[system->model.components[system->model.component[copy]].lead];
}

/* Marks the copies and chunks that the components' states leave alone. */
static void gxsp_mark_still(gxsp_system *system) {
    uint32_t c, k;
    size_t i;
    for (i = 0; i < system->model.n; i++)
        system->state.still[i] =
            system->model.fixed[i] || (system->model.components[system->model.component[i]].state & GXSP_ASLEEP);
    for (c = 0; c < system->mesh.chunk_count; c++) {
        system->state.chunk_still[c] = 1;
        for (k = 0; k < system->mesh.chunks[c].node_count; k++)
            system->state.chunk_still[c] &=
                system->state.still[system->mesh.nodes[system->mesh.chunks[c].first_node + k]];
    }
    gxsp_mark_still_blocks(system);
}

/* The vectors that move a vector, and their weights: itself, or its masters. Returns how many: up to 4 in chunks, up to
 * 16 where copies are affine. */
static int gxsp_masters_of(const gxsp_system *system, uint32_t copy, uint32_t *masters, float *weights) {
    const gxsp_follower *follower;
    uint32_t k;
    int count = 0;
    if (!gxsp_follows(system, copy)) {
        masters[0] = copy;
        weights[0] = 1;
        return 1;
    }
    follower = &system->model.followers[system->model.follower[copy]];
    for (k = 0; k < follower->count; k++)
        if (fabs(follower->weight[k]) > 0) {
            masters[count] = follower->master[k];
            weights[count++] = (float)follower->weight[k];
        }
    return count;
}

static int gxsp_element_follows(const gxsp_system *system, const uint32_t *copies) {
    return gxsp_follows(system, copies[0]) || gxsp_follows(system, copies[1]) || gxsp_follows(system, copies[2]) ||
           gxsp_follows(system, copies[3]);
}

/* >>followers: motion from masters, forces to masters -------------------------------------------------------------- */

/* In and out: vectors over copies. A follower moves by the weighted sum of its masters' motion; its forces act on
 * them. */

/* Increments x of followers from those of their masters */
static void gxsp_extend(const gxsp_system *system, gxsp_vector4 *x) {
    uint32_t i, k, c;
    for (i = 0; i < system->model.follower_count; i++) {
        const gxsp_follower *follower = &system->model.followers[i];
        gxsp_vector4 sum = {0, 0, 0, 0};
        for (k = 0; k < follower->count; k++)
            for (c = 0; c < 3; c++) sum[c] += (float)follower->weight[k] * x[follower->master[k]][c];
        memcpy(x[follower->copy], sum, sizeof sum);
    }
}

/* Adds forces y on followers to those on their masters; 0 on followers. */
static void gxsp_reduce(const gxsp_system *system, gxsp_vector4 *y) {
    uint32_t i, k, c;
    for (i = 0; i < system->model.follower_count; i++) {
        const gxsp_follower *follower = &system->model.followers[i];
        for (k = 0; k < follower->count; k++)
            for (c = 0; c < 3; c++) y[follower->master[k]][c] += (float)follower->weight[k] * y[follower->copy][c];
        memset(y[follower->copy], 0, sizeof *y);
    }
}

/* Displacements of followers: that at from (NULL: 0), and the motion of their masters since then */
static void gxsp_follow(const gxsp_system *system, const double *from, double *displacement) {
    uint32_t i, k, c;
    for (i = 0; i < system->model.follower_count; i++) {
        const gxsp_follower *follower = &system->model.followers[i];
        double *to = displacement + 3 * (size_t)follower->copy;
        for (c = 0; c < 3; c++) {
            double sum = from ? from[3 * (size_t)follower->copy + c] : 0;
            for (k = 0; k < follower->count; k++) {
                const size_t master = 3 * (size_t)follower->master[k] + c;
                sum += follower->weight[k] * (displacement[master] - (from ? from[master] : 0));
            }
            to[c] = sum;
        }
    }
}

/* Adds residuals of followers to those of their masters, unless these are still. still: n */
static void gxsp_reduce_residual(const gxsp_system *system, const uint8_t *still, double *r) {
    uint32_t i, k, c;
    for (i = 0; i < system->model.follower_count; i++) {
        const gxsp_follower *follower = &system->model.followers[i];
        for (k = 0; k < follower->count; k++)
            for (c = 0; c < 3 && !still[follower->master[k]]; c++)
                r[3 * (size_t)follower->master[k] + c] += follower->weight[k] * r[3 * (size_t)follower->copy + c];
        memset(r + 3 * (size_t)follower->copy, 0, 3 * sizeof *r);
    }
}

/* Motion of a copy by a direction, times pass->factor: the direction's own, that of its masters if it follows them,
 * 0 if it is fixed */
static void gxsp_copy_direction(const gxsp_pass *pass, uint32_t copy, double *GXSP_RESTRICT to) {
    const gxsp_system *system = pass->system;
    const double *from = pass->from + 3 * (size_t)copy;
    const gxsp_follower *follower;
    double factor = system->model.fixed[copy] ? 0 : pass->factor;
    uint32_t k, c;
    if (!gxsp_follows(system, copy)) {
        to[0] = factor * from[0], to[1] = factor * from[1], to[2] = factor * from[2];
        return;
    }
    to[0] = to[1] = to[2] = 0;
    follower = &system->model.followers[system->model.follower[copy]];
    for (k = 0; k < follower->count; k++) {
        from = pass->from + 3 * (size_t)follower->master[k];
        factor = system->model.fixed[follower->master[k]] ? 0 : pass->factor * follower->weight[k];
        for (c = 0; c < 3; c++) to[c] += factor * from[c];
    }
}

/* >>transfer: from one level of the multigrid to the next ---------------------------------------------------------- */

/* In: places of a level's nodes in spacings of the next lattice, and which nodes are neighbours. Out: the next
 * level's nodes, parents and weights. A coarse node is a point of the lattice together with one cluster, that is
 * one connected set of the nodes in its support, so that coarse functions never cross a cut (the copies' own
 * idea, one level up). Values between lattice points are linear on the six tetrahedra around a cell's diagonal:
 * at most four weights, exact for affine fields. */

/* A coordinate in spacings of a lattice. Keeps lattice planes off those of the mesh */
static float gxsp_place(double x, double origin, double spacing) { return (float)((x - origin) / spacing) + 0.31f; }

/* Spacing of the first lattice: GXSP_SPACING edges of an average whole element; 0: there is no lattice */
static double gxsp_find_spacing(const gxs_model *model) {
    double volume = 0;
    size_t e, counted = 0;
    for (e = 0; e < model->element_count; e++) {
        const double *g = &model->elements[e].gradient[1][0];
        double inverse = g[0] * (g[4] * g[8] - g[5] * g[7]) + g[1] * (g[5] * g[6] - g[3] * g[8]) +
                         g[2] * (g[3] * g[7] - g[4] * g[6]);
        if (fabs(inverse) > 0) {
            volume += 1 / fabs(inverse) / 6;
            counted++;
        }
    }
    return counted > 0 ? GXSP_SPACING * cbrt(5 * volume / (double)counted) : 0; /* five elements to a cube */
}

/* Rest positions in spacings of the first lattice. 0: there is no lattice. to: n x 3 */
static int gxsp_find_places(const gxsp_system *system, float (*to)[3]) {
    size_t i, k;
    for (i = 0; i < system->model.n; i++)
        for (k = 0; k < 3; k++) {
            to[i][k] =
                gxsp_place(system->model.positions[3 * i + k], system->model.positions[k], system->multigrid.spacing);
            if (!(fabs((double)to[i][k]) < 1e6)) return 0; /* single precision could not hold it */
        }
    return 1;
}

/* Lattice cell, order of axes and weights at a place */
static void gxsp_locate(const float *place, int32_t *cell, uint8_t *axis, float *weight) {
    float f[3];
    int k;
    for (k = 0; k < 3; k++) {
        cell[k] = (int32_t)floor((double)place[k]);
        f[k] = place[k] - (float)cell[k];
        axis[k] = (uint8_t)k;
    }
    for (k = 0; k < 3; k++) { /* three compare-and-swaps sort three numbers: (0 1), (1 2), (0 1) */
        int i = k % 2;
        if (f[axis[i]] < f[axis[i + 1]]) {
            uint8_t first = axis[i];
            axis[i] = axis[i + 1];
            axis[i + 1] = first;
        }
    }
    weight[0] = 1 - f[axis[0]];
    weight[1] = f[axis[0]] - f[axis[1]];
    weight[2] = f[axis[1]] - f[axis[2]];
    weight[3] = f[axis[2]];
}

/* A lattice point as one number, never 0. 2^20 points along each axis suffice for any 32-bit count of elements near
 * each other; farther ones would share a number, but no cluster. */
static uint64_t gxsp_lattice_key(const int32_t *point) {
    return ((uint64_t)((uint32_t)point[0] & 0x1fffffu) << 42 | (uint64_t)((uint32_t)point[1] & 0x1fffffu) << 21 |
            ((uint32_t)point[2] & 0x1fffffu)) +
           1;
}

/* Keys of the four points of the tetrahedron from a cell along axes */
static void gxsp_tetrahedron_keys(const int32_t *cell, const uint8_t *axis, uint64_t *key) {
    int32_t point[3];
    int k;
    memcpy(point, cell, sizeof point);
    key[0] = gxsp_lattice_key(point);
    for (k = 0; k < 3; k++) {
        point[axis[k]]++;
        key[k + 1] = gxsp_lattice_key(point);
    }
}

/* Scratch for the transfer of a level: the four lattice points around each node; those of weight 0 are left out */
typedef struct gxsp_transfer {
    uint64_t *key;    /* n x 4; 0: left out */
    uint32_t *forest; /* n x 4 */
} gxsp_transfer;

/* Nodes i and j are neighbours: they are in one cluster of each lattice point around both. */
static void gxsp_join_nodes(gxsp_transfer *transfer, uint32_t i, uint32_t j) {
    const uint64_t *a = transfer->key + 4 * (size_t)i, *b = transfer->key + 4 * (size_t)j;
    uint32_t p, q;
    for (p = 0; p < 4; p++) {
        if (a[p] == 0) continue;
        for (q = 0; q < 4; q++)
            if (a[p] == b[q]) gxsp_join(transfer->forest, 4 * i + p, 4 * j + q);
    }
}

/* Lattice points and weights of a level's nodes, before clusters are joined. place: n x 3, in spacings of the next
 * lattice */
static void gxsp_transfer_begin(const gxsp_level *level, float (*place)[3], const uint8_t *left_out,
                                gxsp_transfer *transfer) {
    uint32_t i;
    int k;
    for (i = 0; i < level->n; i++) {
        int32_t cell[3];
        uint8_t axis[3];
        gxsp_locate(place[i], cell, axis, level->weight[i]);
        gxsp_tetrahedron_keys(cell, axis, transfer->key + 4 * (size_t)i);
        for (k = 0; k < 4; k++) {
            transfer->forest[4 * (size_t)i + (size_t)k] = 4 * i + (uint32_t)k;
            /* the error that dropping weights below 1e-4 makes in an affine field is far below what the smoother
             * removes */
            if (level->weight[i][k] < 1e-4f || (left_out && left_out[i])) {
                transfer->key[4 * (size_t)i + (size_t)k] = 0;
                level->weight[i][k] = 0;
            }
        }
    }
}

/* Numbers the clusters, which are the next level's nodes. Returns how many there are. */
static uint32_t gxsp_transfer_end(gxsp_level *level, gxsp_transfer *transfer) {
    uint32_t slot, count = 0;
    /* roots come first in their tree: the lower index wins in gxsp_join */
    for (slot = 0; slot < 4 * level->n; slot++) {
        uint32_t *parent = &level->parent[slot / 4][slot % 4], root;
        if (transfer->key[slot] == 0) {
            *parent = GXSP_NONE;
            continue;
        }
        root = gxsp_root(transfer->forest, slot);
        *parent = root == slot ? count++ : level->parent[root / 4][root % 4];
    }
    return count;
}

static void gxsp_transfer_places(const gxsp_level *level, const gxsp_transfer *transfer, gxsp_level *next) {
    uint32_t slot;
    for (slot = 0; slot < 4 * level->n; slot++)
        if (transfer->key[slot] != 0) {
            uint64_t key = transfer->key[slot] - 1;
            int k;
            for (k = 0; k < 3; k++) { /* 21 bits with their sign */
                uint32_t bits = (uint32_t)(key >> (42 - 21 * k)) & 0x1fffffu;
                next->place[level->parent[slot / 4][slot % 4]][k] = (int32_t)bits - (bits & 0x100000u ? 0x200000 : 0);
            }
        }
}

/* Memory for the transfer of a level to the next */
static void gxsp_transfer_make(gxsp_pool *pool, gxsp_level *level) {
    level->parent = (uint32_t(*)[4])gxsp_take(pool, level->n, sizeof *level->parent);
    level->weight = (float(*)[4])gxsp_take(pool, level->n, sizeof *level->weight);
}

/* Memory for a coarse level of n nodes, without its matrix and what the last level does not have */
static void gxsp_level_make(gxsp_pool *pool, gxsp_level *level, uint32_t n) {
    level->n = n;
    level->place = (int32_t(*)[3])gxsp_take(pool, n, sizeof *level->place);
    level->start = (uint32_t *)gxsp_take(pool, (size_t)n + 1, sizeof(uint32_t));
    level->x = (gxsp_vector4 *)gxsp_take(pool, n, sizeof(gxsp_vector4));
    level->b = (gxsp_vector4 *)gxsp_take(pool, n, sizeof(gxsp_vector4));
}

/* >>levels: patterns of the coarse matrices, envelope of the factor ------------------------------------------------ */

/* In: a level's pattern and transfer. Out: the pattern of the next level's matrix, and order and envelope of the
 * last one's factor. Writes gxsp_multigrid, but no numbers. */

/* Numbers in the blocks of a level's matrix, and one more: products read a column as four numbers. */
static size_t gxsp_block_numbers(const gxsp_level *level) { return 9 * (size_t)level->start[level->n] + 1; }

/* Growing list of a matrix's entries (row, column), row <= column; in scratch */
typedef struct gxsp_list {
    gxsp_pool *scratch;
    uint32_t (*pair)[2], count, room;
} gxsp_list;

static void gxsp_list_add(gxsp_list *list, uint32_t row, uint32_t column) {
    if (list->count == list->room) {
        const uint32_t room = 2 * list->room + 1024;
        uint32_t(*larger)[2] = (uint32_t(*)[2])gxsp_grow(list->scratch, list->pair, list->count, room, sizeof *larger);
        if (!larger) return;
        list->pair = larger;
        list->room = room;
    }
    list->pair[list->count][0] = row;
    list->pair[list->count++][1] = column;
}

/* Rows of a level's matrix from its entries (row, column) on and above the diagonal, which may be listed more than
 * once. before: the level before an update, whose entries between nodes that are not dirty stay and are not listed;
 * NULL: all are listed */
static void gxsp_rows_make(gxsp_pool *pool, gxsp_pool *scratch, gxsp_level *level, const gxsp_list *list,
                           const gxsp_level *before, const uint8_t *dirty) {
    const uint32_t old = before ? before->n : 0;
    uint32_t *start = (uint32_t *)gxsp_take(scratch, (size_t)level->n + 2, sizeof(uint32_t));
    uint32_t *listed = (uint32_t *)gxsp_take(scratch, list->count, sizeof(uint32_t));
    uint32_t *columns =
        (uint32_t *)gxsp_take(scratch, (old > 0 ? before->start[old] : 0) + list->count, sizeof(uint32_t));
    uint32_t *seen = (uint32_t *)gxsp_take(scratch, level->n, sizeof(uint32_t)), i, k, count = 0;
    if (scratch->failed) return;
    for (i = 0; i < list->count; i++) start[list->pair[i][0] + 2]++;
    for (i = 0; i < level->n; i++) start[i + 2] += start[i + 1];
    for (i = 0; i < list->count; i++) listed[start[list->pair[i][0] + 1]++] = list->pair[i][1];
    for (i = 0; i < level->n; i++) {
        level->start[i] = count;
        for (k = i < old ? before->start[i] : 0; i < old && !dirty[i] && k < before->start[i + 1]; k++)
            if (!dirty[before->column[k]]) {
                seen[before->column[k]] = i + 1;
                columns[count++] = before->column[k];
            }
        for (k = start[i]; k < start[i + 1]; k++)
            if (seen[listed[k]] != i + 1) {
                seen[listed[k]] = i + 1;
                columns[count++] = listed[k];
            }
        gxsp_sort_row(columns + level->start[i], count - level->start[i]);
    }
    level->start[level->n] = count;
    level->column = (uint32_t *)gxsp_take(pool, count, sizeof(uint32_t));
    if (!pool->failed) memcpy(level->column, columns, count * sizeof(uint32_t));
}

/* Index of column j in row i, or of a lower column if the row does not have it */
static uint32_t gxsp_find_entry(const gxsp_level *level, uint32_t i, uint32_t j) {
    uint32_t low = level->start[i], high = level->start[i + 1];
    while (high - low > 1) {
        uint32_t middle = low + (high - low) / 2;
        if (level->column[middle] <= j)
            low = middle;
        else
            high = middle;
    }
    return low;
}

/* Rows of the next level's matrix, transfer^T A transfer, from those of a level */
static void gxsp_coarse_rows(gxsp_pool *pool, gxsp_pool *scratch, gxsp_level *level) {
    gxsp_level *next = level + 1;
    uint32_t *seen = (uint32_t *)gxsp_take(scratch, next->n, sizeof(uint32_t)),
             *met = (uint32_t *)gxsp_take(scratch, next->n, sizeof(uint32_t));
    uint32_t i, k, p, t, count;
    gxsp_list list;
    memset(&list, 0, sizeof list);
    list.scratch = scratch;
    for (i = 0; i < next->n; i++) gxsp_list_add(&list, i, i);
    for (i = 0; i < level->n && !scratch->failed; i++) {
        for (k = level->start[i], count = 0; k < level->start[i + 1]; k++) {
            const uint32_t *parent = level->parent[level->column[k]];
            for (p = 0; p < 4; p++) {
                if (parent[p] == GXSP_NONE || seen[parent[p]] == i + 1) continue;
                seen[parent[p]] = i + 1;
                met[count++] = parent[p];
            }
        }
        for (p = 0; p < 4; p++)
            for (t = 0; t < count && level->parent[i][p] != GXSP_NONE; t++)
                if (met[t] != level->parent[i][p])
                    gxsp_list_add(&list, met[t] < level->parent[i][p] ? met[t] : level->parent[i][p],
                                  met[t] < level->parent[i][p] ? level->parent[i][p] : met[t]);
    }
    if (!scratch->failed) gxsp_rows_make(pool, scratch, next, &list, NULL, NULL);
}

/* Adds the level after levels[depth], depth > 0, with twice its spacing. 0: it would not be much smaller. What it takes
 * of scratch stays there. */
static int gxsp_add_level(gxsp_system *system, gxsp_pool *scratch, uint32_t depth) {
    gxsp_level *level = &system->multigrid.levels[depth], *next = level + 1;
    gxsp_pool *pool = &system->multigrid.pool;
    gxsp_owned *mark = pool->last;
    gxsp_transfer transfer;
    float(*place)[3] = (float(*)[3])gxsp_take(scratch, level->n, sizeof *place);
    uint32_t i, k, count;
    transfer.key = (uint64_t *)gxsp_take(scratch, 4 * (size_t)level->n, sizeof(uint64_t));
    transfer.forest = (uint32_t *)gxsp_take(scratch, 4 * (size_t)level->n, sizeof(uint32_t));
    gxsp_transfer_make(pool, level);
    if (scratch->failed || pool->failed) return 0;
    for (i = 0; i < level->n; i++)
        for (k = 0; k < 3; k++) place[i][k] = 0.5f * (float)level->place[i][k];
    gxsp_transfer_begin(level, place, NULL, &transfer);
    for (i = 0; i < level->n; i++)
        for (k = level->start[i] + 1; k < level->start[i + 1]; k++) gxsp_join_nodes(&transfer, i, level->column[k]);
    count = gxsp_transfer_end(level, &transfer);
    if (count > level->n - level->n / 3) {
        gxsp_release_to(pool, mark);
        level->parent = NULL, level->weight = NULL;
        return 0;
    }
    level->inverse = (float *)gxsp_take(pool, 6 * (size_t)level->n, sizeof(float));
    level->r = (gxsp_vector4 *)gxsp_take(pool, level->n, sizeof(gxsp_vector4));
    gxsp_level_make(pool, next, count);
    if (pool->failed) return 0;
    gxsp_transfer_places(level, &transfer, next);
    gxsp_coarse_rows(pool, scratch, level);
    return !pool->failed && !scratch->failed;
}

/* Neighbours of each node of a level, in both directions; in scratch */
typedef struct gxsp_graph {
    uint32_t n, *start, *other; /* start: n + 2 */
} gxsp_graph;

static gxsp_graph gxsp_graph_make(gxsp_pool *scratch, const gxsp_level *level) {
    gxsp_graph graph;
    uint32_t i, k;
    graph.n = level->n;
    graph.start = (uint32_t *)gxsp_take(scratch, (size_t)level->n + 2, sizeof(uint32_t));
    graph.other = (uint32_t *)gxsp_take(scratch, 2 * (size_t)level->start[level->n], sizeof(uint32_t));
    if (scratch->failed) return graph;
    for (i = 0; i < level->n; i++)
        for (k = level->start[i] + 1; k < level->start[i + 1]; k++)
            graph.start[i + 2]++, graph.start[level->column[k] + 2]++;
    for (i = 0; i < level->n; i++) graph.start[i + 2] += graph.start[i + 1];
    for (i = 0; i < level->n; i++)
        for (k = level->start[i] + 1; k < level->start[i + 1]; k++) {
            graph.other[graph.start[i + 1]++] = level->column[k];
            graph.other[graph.start[level->column[k] + 1]++] = i;
        }
    return graph;
}

/* Appends the connected component of a seed to order, breadth first. place: GXSP_NONE for nodes not met yet. cost:
 * multiplications of a factorisation so far; once they are more than the limit, it stops. Returns the new length. */
static uint32_t gxsp_order_component(const gxsp_graph *graph, uint32_t seed, uint32_t count, uint32_t *order,
                                     uint32_t *place, double limit, double *cost) {
    uint32_t done = count, k;
    place[seed] = count;
    order[count++] = seed;
    *cost += 13.5;
    for (; done < count && *cost <= limit; done++)
        for (k = graph->start[order[done]]; k < graph->start[order[done] + 1]; k++)
            if (place[graph->other[k]] == GXSP_NONE) {
                const double width = count - done + 1; /* no neighbour comes before the one that it is met from */
                *cost += 13.5 * width * width;         /* three rows, each of width squared / 2 */
                place[graph->other[k]] = count;
                order[count++] = graph->other[k];
            }
    return count;
}

/* The first place in whose column row i of the factor has an entry */
static uint32_t gxsp_first_place(const gxsp_graph *graph, const uint32_t *order, const uint32_t *place, uint32_t i) {
    uint32_t first = i, k;
    for (k = graph->start[order[i]]; k < graph->start[order[i] + 1]; k++)
        first = place[graph->other[k]] < first ? place[graph->other[k]] : first;
    return first;
}

/* Order for a small envelope: one connected component after the other, each breadth first from a node that was last
 * from some other. place: n, scratch. Returns the multiplications of a factorisation; if they are more than the limit,
 * the order is not finished. */
static double gxsp_order_level(const gxsp_graph *graph, uint32_t *order, uint32_t *place, double limit) {
    uint32_t seed, i, k, count = 0, end;
    double cost = 0, ignored = 0;
    memset(place, 0xff, graph->n * sizeof *place);
    for (seed = 0; seed < graph->n && cost <= limit; seed++) {
        if (place[seed] != GXSP_NONE) continue;
        end = gxsp_order_component(graph, seed, count, order, place, HUGE_VAL, &ignored);
        k = order[end - 1];
        for (i = count; i < end; i++) place[order[i]] = GXSP_NONE;
        count = gxsp_order_component(graph, k, count, order, place, limit, &cost);
    }
    return cost;
}

/* Is a level small enough to be factored? */
static int gxsp_factors(gxsp_pool *scratch, const gxsp_level *level, size_t copies) {
    gxsp_owned *mark = scratch->last;
    uint32_t *order = (uint32_t *)gxsp_take(scratch, 2 * (size_t)level->n, sizeof(uint32_t));
    const double limit = GXSP_FACTOR_COST * (double)copies;
    const gxsp_graph graph = gxsp_graph_make(scratch, level);
    const int factors = !scratch->failed && gxsp_order_level(&graph, order, order + level->n, limit) <= limit;
    gxsp_release_to(scratch, mark);
    return factors;
}

/* Row i of the factor, indexed by column; valid from its first column on. Each row of a place is one column longer
 * than the one before. */
static inline float *gxsp_factor_row(const gxsp_factor *factor, uint32_t i) {
    const uint32_t place = i / 3, r = i % 3;
    return factor->entry + (factor->row[place] + r * (size_t)(3 * place - factor->first[place] + 1) + (r == 2));
}

/* Order and envelope of the last level's factor */
static void gxsp_factor_make(gxsp_system *system, gxsp_pool *scratch) {
    const gxsp_level *level = &system->multigrid.levels[system->multigrid.level_count - 1];
    gxsp_factor *factor = &system->multigrid.factor;
    uint32_t *place = (uint32_t *)gxsp_take(scratch, level->n, sizeof(uint32_t)), i;
    const gxsp_graph graph = gxsp_graph_make(scratch, level);
    size_t entries = 0;
    factor->n = 3 * level->n;
    factor->order = (uint32_t *)gxsp_take(&system->multigrid.pool, level->n, sizeof(uint32_t));
    factor->first = (uint32_t *)gxsp_take(&system->multigrid.pool, level->n, sizeof(uint32_t));
    factor->row = (size_t *)gxsp_take(&system->multigrid.pool, level->n, sizeof(size_t));
    factor->x = (double *)gxsp_take(&system->multigrid.pool, factor->n, sizeof(double));
    if (scratch->failed || system->multigrid.pool.failed) return;
    (void)gxsp_order_level(&graph, factor->order, place, HUGE_VAL);
    for (i = 0; i < level->n; i++) {
        const uint32_t first = 3 * gxsp_first_place(&graph, factor->order, place, i);
        factor->first[i] = first;
        factor->row[i] = entries - first; /* not negative: every row before has an entry */
        entries += 3 * (size_t)(3 * i - first) + 6;
    }
    if (system->affine.count > 0)
        system->affine.entry = (double *)gxsp_take(&system->multigrid.pool, entries, sizeof(double));
    else
        factor->entry = (float *)gxsp_take(&system->multigrid.pool, entries, sizeof(float));
    factor->entry_count = entries;
}

/* >>nested: level 1 where copies are affine ------------------------------------------------------------------------ */

/* In: the transfer of level 0 between copies. Out: coarse nodes that carry an affine motion as well, and what they add
 * to the pattern of level 1. The space of affine copies is nested in itself: with the lattice's weights w_iJ,
 *   a_i = sum w_iJ (b_J + B_J (X_i - X_J)),   A_i = sum w_iJ B_J.
 * The columns of B_J are three further nodes of level 1, the hidden ones of J, where a child of J is affine. Copies
 * that are not affine follow b_J only. */

/* Parents of a vector on level 1 and their weights; at most 16. Returns how many. */
static uint32_t gxsp_nested_parents(const gxsp_system *system, uint32_t vector, uint32_t *parents, float *weights) {
    const gxsp_affine *affine = &system->affine;
    const uint32_t place = affine->place[vector], part = place == GXSP_NONE ? 0 : place & 3,
                   copy = part > 0 ? affine->member[place / 4][0] : vector;
    uint32_t count = 0;
    int k, a;
    for (k = 0; k < 4; k++) {
        const uint32_t parent = system->multigrid.levels[0].parent[copy][k];
        const float weight = system->multigrid.levels[0].weight[copy][k];
        if (parent == GXSP_NONE) continue;
        parents[count] = part == 0 ? parent : affine->hidden[parent] + part - 1;
        weights[count++] = weight;
        for (a = 0; a < 3 && part == 0 && place != GXSP_NONE; a++) {
            parents[count] = affine->hidden[parent] + (uint32_t)a;
            weights[count++] = weight * affine->offset[place / 4][k][a];
        }
    }
    return count;
}

/* Gives hidden nodes, from number `nodes` on, to the parents of affine copies that have none. hidden: by node, count of
 * them. Returns the number of nodes. */
static uint32_t gxsp_nested_nodes(gxsp_system *system, uint32_t count, uint32_t nodes) {
    gxsp_affine *affine = &system->affine;
    uint32_t group;
    int k;
    for (group = 0; group < affine->group_count; group++)
        for (k = 0; k < 4; k++) {
            const uint32_t parent = system->multigrid.levels[0].parent[affine->member[group][0]][k];
            if (parent == GXSP_NONE || affine->hidden[parent] != GXSP_NONE) continue;
            affine->hidden[parent] = nodes;
            nodes += 3;
        }
    affine->hidden_count = count;
    return nodes;
}

/* Offsets of affine copies from their parents, whose places are known */
static void gxsp_nested_offsets(gxsp_system *system) {
    gxsp_affine *affine = &system->affine;
    const gxsp_level *fine = &system->multigrid.levels[0];
    uint32_t group;
    int k, a;
    for (group = 0; group < affine->group_count; group++)
        for (k = 0; k < 4; k++)
            for (a = 0; a < 3; a++) {
                const uint32_t copy = affine->member[group][0], parent = fine->parent[copy][k];
                const double x = system->model.positions[3 * (size_t)copy + (size_t)a];
                const float place = gxsp_place(x, affine->origin[a], system->multigrid.spacing) / affine->stretch;
                if (parent == GXSP_NONE) continue;
                affine->offset[group][k][a] =
                    (float)(((double)place - fine[1].place[parent][a]) *
                            ((double)affine->stretch * system->multigrid.spacing) / affine->length);
            }
}

/* Adds the clusters that the elements join. */
static void gxsp_nested_join(const gxsp_system *system, gxsp_transfer *transfer) {
    uint32_t b;
    int l, k;
    for (b = 0; b < system->affine.block_count; b++)
        for (l = 0; l < GXSP_LANES; l++)
            for (k = 0; k < 6 && system->affine.blocks[b].rest.weight[l] > 0; k++)
                gxsp_join_nodes(transfer, system->affine.blocks[b].vector[gxsp_edge_ends[k][0]][l],
                                system->affine.blocks[b].vector[gxsp_edge_ends[k][1]][l]);
}

/* The coarse nodes around an element, without hidden ones: at most 16. Returns how many. */
static uint32_t gxsp_nested_bases(const gxsp_system *system, const gxsp_affine_block *block, int l, uint32_t *bases) {
    uint32_t count = 0, i, k;
    for (k = 0; k < 16 && block->rest.weight[l] > 0; k++) {
        const uint32_t parent = system->multigrid.levels[0].parent[block->vector[k / 4][l]][k % 4];
        for (i = 0; i < count && bases[i] != parent; i++) {}
        if (parent != GXSP_NONE && i == count) bases[count++] = parent;
    }
    return count;
}

static int gxsp_compare_keys(const void *a, const void *b) {
    const uint64_t p = *(const uint64_t *)a, q = *(const uint64_t *)b;
    return (p > q) - (p < q);
}

/* Has an element a coarse node that is dirty? */
static int gxsp_nested_dirty(const gxsp_system *system, const gxsp_affine_block *block, int l, const uint8_t *dirty) {
    uint32_t bases[16], i, count = gxsp_nested_bases(system, block, l, bases);
    for (i = 0; i < count && !dirty[bases[i]]; i++) {}
    return i < count;
}

/* Lists the entries of a coarse node and another one, or itself, with their hidden nodes. */
static void gxsp_nested_entries(const uint32_t *hidden, uint32_t p, uint32_t q, gxsp_list *list) {
    const uint32_t some = hidden[p] == GXSP_NONE ? 1 : 4, others = hidden[q] == GXSP_NONE ? 1 : 4;
    uint32_t i, j;
    for (i = 0; i < some; i++)
        for (j = 0; j < others; j++) {
            const uint32_t a = i == 0 ? p : hidden[p] + i - 1, b = j == 0 ? q : hidden[q] + j - 1;
            if (p != q || i < j) gxsp_list_add(list, a < b ? a : b, a < b ? b : a);
        }
}

/* Lists the entries of level 1's matrix to which the elements add. dirty: by coarse node; only entries with a dirty
 * node are listed; NULL: all are */
static void gxsp_nested_pattern(const gxsp_system *system, gxsp_pool *scratch, const uint8_t *dirty, gxsp_list *list) {
    const gxsp_affine *affine = &system->affine;
    uint64_t *key = (uint64_t *)gxsp_take(scratch, (size_t)affine->block_count * GXSP_LANES * 136, sizeof *key);
    uint32_t bases[16], b, i, j, count;
    size_t k, keys = 0;
    int l;
    if (!key) return;
    for (b = 0; b < affine->block_count; b++)
        for (l = 0; l < GXSP_LANES; l++)
            for (count = gxsp_nested_bases(system, &affine->blocks[b], l, bases), i = 0; i < count; i++)
                for (j = i; j < count; j++) {
                    if (dirty && !dirty[bases[i]] && !dirty[bases[j]]) continue;
                    key[keys++] =
                        bases[i] < bases[j] ? (uint64_t)bases[i] << 32 | bases[j] : (uint64_t)bases[j] << 32 | bases[i];
                }
    qsort(key, keys, sizeof *key, gxsp_compare_keys);
    for (k = 0; k < keys; k++)
        if (k == 0 || key[k] != key[k - 1])
            gxsp_nested_entries(affine->hidden, (uint32_t)(key[k] >> 32), (uint32_t)key[k], list);
}

/* Coarse nodes, without hidden ones, around the copies of a pair that are on one side by the sign of their weights. At
 * most as many as bases holds. Returns how many. */
static uint32_t gxsp_pair_bases(const gxsp_system *system, const gxsp_term *term, int sign, uint32_t *bases) {
    const gxsp_share *share = system->lasting->share + term->first, *end = share + term->count;
    uint32_t count = 0, i, k;
    for (; share < end; share++)
        for (k = 0; k < 4 && !gxsp_is_hidden(system, share->copy); k++) {
            const uint32_t parent = system->multigrid.levels[0].parent[share->copy][k];
            if (sign > 0 ? !(share->weight > 0) : !(share->weight < 0)) continue;
            for (i = 0; i < count && bases[i] != parent; i++) {}
            if (parent != GXSP_NONE && i == count) bases[count++] = parent;
        }
    return count;
}

/* Hash of which copies present pairs have on which side; at least 2, or 0: there are no pairs */
static uint64_t gxsp_hash_sides(const gxsp_system *system) {
    uint64_t hash = 0;
    size_t t;
    uint32_t i;
    for (t = 0; t < system->lasting->count; t++) {
        const gxsp_term *term = &system->lasting->term[t];
        const gxsp_share *share = system->lasting->share + term->first;
        for (i = 0; i < term->count && term->spread > 0; i++) {
            hash = (hash ^ (2 * (uint64_t)share[i].copy + (share[i].weight > 0))) * 0x9e3779b97f4a7c15u;
            hash ^= hash >> 29;
        }
        if (term->spread > 0) hash |= 2;
    }
    return hash;
}

/* Lists the entries of level 1's matrix between the two sides of pairs. */
static void gxsp_joint_pattern(const gxsp_system *system, gxsp_pool *scratch, gxsp_list *list) {
    uint32_t *last = (uint32_t *)gxsp_take(scratch, system->multigrid.levels[1].n, sizeof(uint32_t));
    uint32_t one[4 * GXS_POINT_MOST], other[4 * GXS_POINT_MOST], i, j, e;
    gxsp_list chain = {NULL, NULL, 0, 0}; /* column, the entry of the same row before it + 1 */
    size_t t;
    chain.scratch = scratch;
    for (t = 0; t < system->lasting->count && !scratch->failed; t++) {
        const gxsp_term *term = &system->lasting->term[t];
        const uint32_t some = term->spread > 0 ? gxsp_pair_bases(system, term, 1, one) : 0,
                       others = some > 0 ? gxsp_pair_bases(system, term, -1, other) : 0;
        for (i = 0; i < some; i++)
            for (j = 0; j < others; j++) {
                const uint32_t row = one[i] < other[j] ? one[i] : other[j],
                               column = one[i] < other[j] ? other[j] : one[i];
                for (e = last[row]; e > 0 && chain.pair[e - 1][0] != column; e = chain.pair[e - 1][1]) {}
                if (e > 0 || row == column) continue;
                gxsp_list_add(&chain, column, last[row]);
                if (scratch->failed) return;
                last[row] = chain.count;
                gxsp_nested_entries(system->affine.hidden, row, column, list);
            }
    }
}

/* >>pattern: edges of chunks, pattern of level 1 and of the assembled matrix --------------------------------------- */

/* In: chunks and the transfer of level 0. Out: the rows of level 1's matrix, found without an assembled one, and
 * the pattern of the assembled matrix. Edges and pairs are of one chunk at a time, in scratch or shared memory. */

/* Corners of the ten blocks of an element, in the order of gxs_element.mass */
static const int gxsp_pair_corners[10][2] = {{0, 0}, {0, 1}, {0, 2}, {0, 3}, {1, 1},
                                             {1, 2}, {1, 3}, {2, 2}, {2, 3}, {3, 3}};

/* Arrays for the edges of any chunk. numbers: with those for blocks of the Hessian; edges are counted then */
static void gxsp_edges_carve(gxsp_system *system, gxsp_space *space, int numbers) {
    gxsp_edges *edges = &system->multigrid.edges;
    size_t c, lanes = 0, nodes = 1, most = 0;
    for (c = 0; c < system->mesh.chunk_count; c++) {
        const gxsp_chunk *chunk = &system->mesh.chunks[c];
        const size_t lanes_here = chunk->block_count * GXSP_LANES,
                     count = numbers ? chunk->edge_count : 1 + 6 * lanes_here;
        lanes = lanes_here > lanes ? lanes_here : lanes;
        nodes = chunk->node_count > nodes ? chunk->node_count : nodes;
        most = count > most ? count : most;
    }
    edges->table = (uint16_t *)gxsp_carve(space, nodes * (nodes - 1) / 2, sizeof(uint16_t));
    edges->table_size = nodes * (nodes - 1) / 2;
    edges->ends = (uint32_t *)gxsp_carve(space, most + 1, sizeof(uint32_t)); /* one more is written than counted */
    edges->parent = (uint16_t(*)[4])gxsp_carve(space, nodes, sizeof *edges->parent);
    if (!numbers) return;
    edges->block = (float(*)[9])gxsp_carve(space, most, sizeof *edges->block);
    edges->element = (uint16_t(*)[6][GXSP_LANES])gxsp_carve(space, lanes / GXSP_LANES, sizeof *edges->element);
    edges->first = (uint16_t *)gxsp_carve(space, nodes, sizeof(uint16_t));
    edges->next = (uint16_t *)gxsp_carve(space, most, sizeof(uint16_t));
    edges->joined = (uint8_t *)gxsp_carve(space, nodes, 1);
    edges->own = (float(*)[9])gxsp_carve(space, nodes, sizeof *edges->own);
    edges->mass = (float *)gxsp_carve(space, nodes, sizeof(float));
}

/* Memory for listing the edges of any chunk, in scratch */
static void gxsp_edges_make(gxsp_system *system, gxsp_pool *scratch) {
    gxsp_space space = {NULL, 0};
    gxsp_edges_carve(system, &space, 0);
    space.memory = (unsigned char *)gxsp_take(scratch, space.used, 1);
    space.used = 0;
    gxsp_edges_carve(system, &space, 0);
}

static void gxsp_edges_begin(gxsp_edges *edges, const gxsp_chunk *chunk) {
    edges->nodes = chunk->node_count;
    edges->count = 1;
}

/* The edge of two nodes, made if there is none yet; 0 for a node and itself. Has no branch on whether there is one:
 * processors could not predict it. count: edges so far */
static inline uint16_t gxsp_find_edge(const gxsp_edges *edges, uint32_t i, uint32_t j, uint32_t *count) {
    const uint32_t low = i < j ? i : j, high = i < j ? j : i, ends = low << 16 | high;
    uint16_t *entry = &edges->table[high * (high - 1) / 2 + low];
    int made;
    if (low == high) return 0;
    made = (*entry >= *count) | (edges->ends[*entry] != ends);
    edges->ends[*count] = ends;
    *entry = made ? (uint16_t)*count : *entry;
    *count += (uint32_t)made;
    return *entry;
}

/* The six edges of each element of a block; 0 where the element has no weight */
static void gxsp_block_edges(gxsp_edges *edges, const gxsp_chunk *chunk, uint32_t b, uint16_t (*edge)[GXSP_LANES]) {
    const gxsp_corners *corner = &chunk->corners[b];
    uint32_t count = edges->count;
    int i, j, l, pair = 0;
    for (i = 0; i < 4; i++)
        for (j = i + 1; j < 4; j++, pair++)
            for (l = 0; l < GXSP_LANES; l++)
                edge[pair][l] = chunk->rest[b].weight[l] > 0
                                  ? gxsp_find_edge(edges, corner->node[i][l], corner->node[j][l], &count)
                                  : 0;
    edges->count = count;
}

/* Lists the edges of a chunk's elements that have weight. */
static void gxsp_list_edges(gxsp_system *system, gxsp_chunk *chunk) {
    uint16_t edge[6][GXSP_LANES];
    uint32_t b;
    gxsp_edges_begin(&system->multigrid.edges, chunk);
    for (b = 0; b < chunk->block_count; b++) gxsp_block_edges(&system->multigrid.edges, chunk, b, edge);
    chunk->edge_count = system->multigrid.edges.count;
}

/* Counts the edges of chunks for which they are not known. */
static void gxsp_count_edges(gxsp_system *system) {
    uint32_t c;
    for (c = 0; c < system->mesh.chunk_count; c++)
        if (system->mesh.chunks[c].edge_count == 0) gxsp_list_edges(system, &system->mesh.chunks[c]);
}

/* Numbers the coarse nodes that are parents of a chunk's nodes. */
static void gxsp_pairs_begin(gxsp_system *system, const gxsp_chunk *chunk) {
    gxsp_pairs *pairs = &system->multigrid.pairs;
    uint32_t i, k;
    pairs->round++;
    pairs->count = 1;
    for (i = 0; i < chunk->node_count; i++)
        for (k = 0; k < 4; k++) {
            const uint32_t parent = system->multigrid.levels[0].parent[system->mesh.nodes[chunk->first_node + i]][k];
            system->multigrid.edges.parent[i][k] = 0;
            if (parent == GXSP_NONE) continue;
            if (pairs->stamp[parent] != pairs->round) {
                pairs->stamp[parent] = pairs->round;
                pairs->node[pairs->count] = parent;
                pairs->local[parent] = pairs->count++;
            }
            system->multigrid.edges.parent[i][k] = (uint16_t)pairs->local[parent];
        }
    memset(pairs->seen, 0, pairs->count * sizeof *pairs->seen);
}

/* Arrays for the pairs of any chunk. numbers: with those for entries of matrices */
static void gxsp_pairs_carve(gxsp_system *system, gxsp_space *space, int numbers) {
    gxsp_pairs *pairs = &system->multigrid.pairs;
    const size_t n = system->multigrid.levels[1].n,
                 side = pairs->most < GXSP_CHUNK_PARENTS ? pairs->most : GXSP_CHUNK_PARENTS;
    /* the first level whose matrix is that of another one times transfers */
    const uint32_t next = system->multigrid.fine ? 1 : 2;
    pairs->local = (uint32_t *)gxsp_carve(space, n, sizeof(uint32_t));
    pairs->stamp = (uint32_t *)gxsp_carve(space, n, sizeof(uint32_t));
    pairs->node = (uint32_t *)gxsp_carve(space, n + 1, sizeof(uint32_t));
    pairs->seen = (uint32_t *)gxsp_carve(space, n + 1, sizeof(uint32_t));
    if (!numbers) return;
    pairs->entry = (uint32_t *)gxsp_carve(space, side * side, sizeof(uint32_t));
    system->multigrid.edges.half = (float(*)[9])gxsp_carve(space, pairs->most, sizeof *system->multigrid.edges.half);
    /* one more is written than counted */
    system->multigrid.edges.touched = (uint16_t *)gxsp_carve(space, (size_t)pairs->most + 1, sizeof(uint16_t));
    pairs->half = (float(*)[9])gxsp_carve(
        space, next < system->multigrid.level_count ? system->multigrid.levels[next].n : 0, sizeof *pairs->half);
}

/* Memory for listing the pairs of any chunk, in scratch */
static void gxsp_pairs_make(gxsp_system *system, gxsp_pool *scratch) {
    gxsp_space space = {NULL, 0};
    gxsp_pairs_carve(system, &space, 0);
    space.memory = (unsigned char *)gxsp_take(scratch, space.used, 1);
    space.used = 0;
    gxsp_pairs_carve(system, &space, 0);
    system->multigrid.pairs.round = system->multigrid.pairs.most = 0;
}

/* Sets of a chunk's coarse nodes, as bits in `words` words */
typedef struct gxsp_sets {
    uint64_t *own, *reach; /* by node: its parents; those of its neighbours too */
    uint64_t *row;         /* by number of the coarse node: those that it shares an element with */
    size_t words;
} gxsp_sets;

static void gxsp_join_sets(uint64_t *to, const uint64_t *from, size_t words) {
    size_t k;
    for (k = 0; k < words; k++) to[k] |= from[k];
}

/* The sets of a chunk after gxsp_pairs_begin. memory: room for all */
static gxsp_sets gxsp_find_sets(gxsp_system *system, const gxsp_chunk *chunk, uint64_t *memory) {
    gxsp_sets sets;
    const size_t words = sets.words = (system->multigrid.pairs.count + 63) / 64;
    uint32_t i, k, b;
    size_t word;
    int l;
    sets.own = memory;
    sets.reach = sets.own + chunk->node_count * words;
    sets.row = sets.reach + chunk->node_count * words;
    memset(memory, 0, (2 * (size_t)chunk->node_count + system->multigrid.pairs.count) * words * sizeof *memory);
    for (i = 0; i < chunk->node_count; i++)
        for (k = 0; k < 4; k++)
            if (system->multigrid.levels[0].parent[system->mesh.nodes[chunk->first_node + i]][k] != GXSP_NONE)
                sets.own[i * words + system->multigrid.edges.parent[i][k] / 64] |=
                    (uint64_t)1 << system->multigrid.edges.parent[i][k] % 64;
    for (b = 0; b < chunk->block_count; b++)
        for (l = 0; l < GXSP_LANES; l++) {
            const gxsp_rest *rest = &chunk->rest[b];
            const gxsp_corners *corner = &chunk->corners[b];
            const size_t n0 = corner->node[0][l] * words, n1 = corner->node[1][l] * words,
                         n2 = corner->node[2][l] * words, n3 = corner->node[3][l] * words;
            for (word = 0; word < words && rest->weight[l] > 0; word++) {
                const uint64_t all =
                    sets.own[n0 + word] | sets.own[n1 + word] | sets.own[n2 + word] | sets.own[n3 + word];
                sets.reach[n0 + word] |= all, sets.reach[n1 + word] |= all;
                sets.reach[n2 + word] |= all, sets.reach[n3 + word] |= all;
            }
        }
    for (i = 0; i < chunk->node_count; i++)
        for (k = 0; k < 4; k++)
            if (system->multigrid.levels[0].parent[system->mesh.nodes[chunk->first_node + i]][k] != GXSP_NONE)
                gxsp_join_sets(sets.row + system->multigrid.edges.parent[i][k] * words, sets.reach + i * words, words);
    return sets;
}

/* Lists the entries of level 1's matrix to which a chunk adds. dirty: by coarse node; only entries with a dirty
 * node are listed; NULL: all are. memory: see gxsp_find_sets */
static void gxsp_list_pairs(gxsp_system *system, gxsp_chunk *chunk, uint64_t *memory, const uint8_t *dirty,
                            gxsp_list *list) {
    const uint32_t *node = system->multigrid.pairs.node;
    gxsp_sets sets;
    uint32_t i, k;
    gxsp_pairs_begin(system, chunk);
    chunk->pair_count = system->multigrid.pairs.count;
    sets = gxsp_find_sets(system, chunk, memory);
    for (i = 1; i < system->multigrid.pairs.count; i++)
        for (k = 0; k < sets.words && (!dirty || dirty[node[i]]); k++) {
            uint64_t set = sets.row[i * sets.words + k];
            uint32_t j;
            for (j = 64 * k; set != 0; set >>= 1, j++) {
                if (!(set & 1)) continue;
                if (node[i] < node[j])
                    gxsp_list_add(list, node[i], node[j]);
                else if (dirty && !dirty[node[j]]) /* the other one does not list it */
                    gxsp_list_add(list, node[j], node[i]);
            }
        }
}

/* Pattern of level 1's matrix: two nodes are neighbours where an element has both as parents; every node is its own
 * neighbour. Also the largest number of coarse nodes of a chunk. before: the level before an update; nodes that are in
 * it and not dirty keep their neighbours, chunks without dirty nodes their number. NULL: all are found anew */
static void gxsp_first_pattern(gxsp_system *system, gxsp_pool *scratch, const gxsp_level *before,
                               const uint8_t *dirty) {
    uint32_t c, i, nodes = 0;
    uint64_t *memory;
    gxsp_list list;
    memset(&list, 0, sizeof list);
    list.scratch = scratch;
    system->multigrid.mark = system->multigrid.pool.last;
    for (c = 0; c < system->mesh.chunk_count; c++)
        nodes = system->mesh.chunks[c].node_count > nodes ? system->mesh.chunks[c].node_count : nodes;
    /* four parents to a node */
    memory = (uint64_t *)gxsp_take(scratch, (6 * (size_t)nodes + 1) * (nodes / 16 + 1), sizeof(uint64_t));
    if (scratch->failed) return;
    for (i = 0; i < system->multigrid.levels[1].n; i++)
        if (!before || dirty[i]) gxsp_list_add(&list, i, i);
    for (c = 0; c < system->mesh.chunk_count; c++) {
        gxsp_chunk *chunk = &system->mesh.chunks[c];
        if (!before || chunk->dirty || chunk->pair_count == 0)
            gxsp_list_pairs(system, chunk, memory, before ? dirty : NULL, &list);
        if (chunk->pair_count > system->multigrid.pairs.most) system->multigrid.pairs.most = chunk->pair_count;
    }
    if (system->affine.count > 0) gxsp_nested_pattern(system, scratch, before ? dirty : NULL, &list);
    if (system->multigrid.joined > 0) system->multigrid.joined = before ? 1 : gxsp_hash_sides(system);
    if (system->multigrid.joined > 1) gxsp_joint_pattern(system, scratch, &list);
    if (!scratch->failed)
        gxsp_rows_make(&system->multigrid.pool, scratch, &system->multigrid.levels[1], &list, before, dirty);
}

/* Entries (row, column), row <= column, to which an element adds. Returns how many. */
static uint32_t gxsp_element_pairs(const gxsp_system *system, const uint32_t *copies, uint32_t (*list)[2]) {
    uint32_t all[16], count = 0, listed = 0, i, j;
    float weights[4];
    int k;
    for (k = 0; k < 4; k++) count += (uint32_t)gxsp_masters_of(system, copies[k], all + count, weights);
    for (i = 0; i < count; i++)
        for (j = i; j < count; j++, listed++) {
            list[listed][0] = all[i] < all[j] ? all[i] : all[j];
            list[listed][1] = all[i] < all[j] ? all[j] : all[i];
        }
    return listed;
}

/* The pattern of the assembled matrix on copies that follow nothing: copies are neighbours where they share an
 * element; every copy is its own neighbour. */
static void gxsp_fine_make(gxsp_system *system, gxsp_pool *scratch) {
    gxsp_level *fine = &system->multigrid.levels[0];
    uint32_t c, b, i;
    gxsp_list list = {NULL, NULL, 0, 0};
    int l, pair, pass;
    system->multigrid.fine = (gxsp_fine *)gxsp_take(&system->pool, system->mesh.block_count, sizeof(gxsp_fine));
    fine->start = (uint32_t *)gxsp_take(&system->pool, system->model.n + 1, sizeof(uint32_t));
    fine->inverse = (float *)gxsp_take(&system->pool, 6 * system->model.n, sizeof(float));
    if (system->pool.failed) return;
    for (pass = 0; pass < 2; pass++) { /* count, then list */
        if (pass == 1 && !(list.pair = (uint32_t(*)[2])gxsp_take(scratch, list.count, sizeof *list.pair))) return;
        for (i = 0, list.count = 0; i < fine->n; i++, list.count++)
            if (list.pair) list.pair[list.count][0] = list.pair[list.count][1] = i;
        for (c = 0; c < system->mesh.chunk_count; c++)
            for (b = 0; b < system->mesh.chunks[c].block_count; b++)
                for (l = 0; l < GXSP_LANES; l++) {
                    uint32_t copies[4], pairs[136][2];
                    gxsp_lane_copies(system, &system->mesh.chunks[c], b, l, copies);
                    list.count += gxsp_element_pairs(system, copies, list.pair ? list.pair + list.count : pairs);
                }
    }
    gxsp_rows_make(&system->pool, scratch, fine, &list, NULL, NULL);
    if (!scratch->failed) fine->block = (float *)gxsp_take(&system->pool, gxsp_block_numbers(fine), sizeof(float));
    if (scratch->failed || system->pool.failed) return;
    for (c = 0; c < system->mesh.chunk_count; c++)
        for (i = 0; i < system->mesh.chunks[c].block_count * GXSP_LANES; i++) {
            uint32_t copies[4];
            gxsp_lane_copies(system, &system->mesh.chunks[c], i / GXSP_LANES, (int)(i % GXSP_LANES), copies);
            for (pair = 0; pair < 10; pair++) {
                const uint32_t p = copies[gxsp_pair_corners[pair][0]], q = copies[gxsp_pair_corners[pair][1]];
                system->multigrid.fine[system->mesh.chunks[c].first_block + i / GXSP_LANES]
                    .entry[pair][i % GXSP_LANES] = gxsp_element_follows(system, copies)
                                                     ? GXSP_NONE
                                                     : gxsp_find_entry(fine, p < q ? p : q, p < q ? q : p);
            }
        }
}

/* >>hierarchy: all levels ------------------------------------------------------------------------------------------ */

/* In: the model with its transfer to be made. Out: level_count and the structure of every level; 0 levels if
 * there is nothing to coarsen. */

/* The rows of level 1 and all levels after it. before, dirty: see gxsp_first_pattern */
static void gxsp_levels_make(gxsp_system *system, gxsp_pool *scratch, const gxsp_level *before, const uint8_t *dirty) {
    uint32_t depth;
    gxsp_pairs_make(system, scratch);
    if (scratch->failed) return;
    if (system->multigrid.fine)
        gxsp_coarse_rows(&system->multigrid.pool, scratch, &system->multigrid.levels[0]);
    else
        gxsp_first_pattern(system, scratch, before, dirty);
    gxsp_count_edges(system);
    if (scratch->failed || system->multigrid.pool.failed) return;
    for (depth = 1;
         depth + 1 < GXSP_LEVELS &&
         !gxsp_factors(scratch, &system->multigrid.levels[depth], depth == 1 ? system->model.n / 2 : system->model.n) &&
         gxsp_add_level(system, scratch, depth);
         depth++)
        ;
    system->multigrid.level_count = depth + 1;
    for (depth = 1; !scratch->failed && !system->multigrid.pool.failed &&
                    (depth == 1 || depth + 1 < system->multigrid.level_count);
         depth++)
        system->multigrid.levels[depth].block = (float *)gxsp_take(
            &system->multigrid.pool, gxsp_block_numbers(&system->multigrid.levels[depth]), sizeof(float));
    gxsp_factor_make(system, scratch);
}

/* The transfer of the model by a lattice. place: n x 3, in its spacings. Returns the number of level 1's nodes. */
static uint32_t gxsp_first_transfer(gxsp_system *system, float (*place)[3], const uint8_t *left_out,
                                    gxsp_transfer *transfer) {
    uint32_t c, e;
    gxsp_transfer_begin(&system->multigrid.levels[0], place, left_out, transfer);
    for (c = 0; c < system->mesh.chunk_count; c++) {
        const uint32_t *copies = system->mesh.nodes + system->mesh.chunks[c].first_node;
        gxsp_list_edges(system, &system->mesh.chunks[c]);
        for (e = 1; e < system->multigrid.edges.count; e++)
            gxsp_join_nodes(transfer, copies[system->multigrid.edges.ends[e] >> 16],
                            copies[system->multigrid.edges.ends[e] & 0xffff]);
    }
    for (e = 0; e < 4 * system->model.follower_count; e++)
        if (!gxsp_is_hidden(system, system->model.followers[e / 4].copy) &&
            fabs(system->model.followers[e / 4].weight[e % 4]) > 0)
            gxsp_join_nodes(transfer, system->model.followers[e / 4].copy,
                            system->model.followers[e / 4].master[e % 4]);
    gxsp_nested_join(system, transfer);
    return gxsp_transfer_end(&system->multigrid.levels[0], transfer);
}

/* A component on the first lattice: its copies, nodes and box */
typedef struct gxsp_extent {
    uint32_t copies, nodes;
    float low[3], high[3], length; /* in spacings; length: the longest of high - low */
} gxsp_extent;

static gxsp_extent *gxsp_find_extents(const gxsp_system *system, gxsp_pool *scratch, float (*place)[3]) {
    gxsp_extent *extents = (gxsp_extent *)gxsp_take(scratch, system->model.component_count, sizeof *extents);
    uint32_t slot, i, k, nodes = 0;
    if (!extents) return NULL;
    for (slot = 0; slot < 4 * system->model.n; slot++) /* nodes are numbered as they are met */
        if (system->multigrid.levels[0].parent[slot / 4][slot % 4] == nodes) {
            extents[system->model.component[slot / 4]].nodes++;
            nodes++;
        }
    for (i = 0; i < system->model.n; i++) {
        gxsp_extent *extent = &extents[system->model.component[i]];
        for (k = 0; k < 3; k++) {
            extent->low[k] = extent->copies == 0 || place[i][k] < extent->low[k] ? place[i][k] : extent->low[k];
            extent->high[k] = extent->copies == 0 || place[i][k] > extent->high[k] ? place[i][k] : extent->high[k];
        }
        extent->copies++;
    }
    for (i = 0; i < system->model.component_count; i++)
        for (k = 0; k < 3; k++)
            extents[i].length = extents[i].high[k] - extents[i].low[k] > extents[i].length
                                  ? extents[i].high[k] - extents[i].low[k]
                                  : extents[i].length;
    return extents;
}

/* Small components have so many lattice points around them that fewer serve nearly as well. After
 * gxsp_first_transfer, the places of crowded ones go into one tetrahedron of a lattice of their own size, whose
 * functions are their affine motions, or, if they are larger, into a lattice of twice the spacing. Long ones stay,
 * since they would hardly bend. Returns whether there are any. */
static int gxsp_thin_crowded(const gxsp_system *system, gxsp_pool *scratch, float (*place)[3]) {
    const gxsp_extent *extents = gxsp_find_extents(system, scratch, place);
    uint32_t i, k;
    int any = 0;
    for (i = 0; i < system->model.n && extents; i++) {
        const gxsp_extent *extent = &extents[system->model.component[i]];
        if ((float)extent->nodes <= GXSP_CROWDED * (float)extent->copies || !(extent->length < GXSP_COARSE)) continue;
        any = 1;
        for (k = 0; k < 3; k++) /* else where coordinates descend: in thirds of a cell */
            place[i][k] =
                extent->length >= GXSP_AFFINE
                    ? 0.5f * place[i][k]
                    : 0.3f * (place[i][k] - extent->low[k]) / (extent->length + 1e-30f) + (float)(2 - k) / 3 + 0.01f;
    }
    return any;
}

/* All levels of the multigrid below the model. place: n x 3, see gxsp_find_places. level_count stays 0 if there is
 * nothing to coarsen. */
static void gxsp_multigrid_make(gxsp_system *system, gxsp_pool *scratch, float (*place)[3]) {
    gxsp_level *fine = &system->multigrid.levels[0];
    gxsp_transfer transfer;
    uint8_t *left_out = (uint8_t *)gxsp_take(scratch, system->model.n, 1);
    uint32_t count, i;
    gxsp_edges_make(system, scratch);
    transfer.key = (uint64_t *)gxsp_take(scratch, 4 * system->model.n, sizeof(uint64_t));
    transfer.forest = (uint32_t *)gxsp_take(scratch, 4 * system->model.n, sizeof(uint32_t));
    if (scratch->failed) return;
    for (i = 0; i < system->model.n; i++) left_out[i] = (uint8_t)gxsp_is_left_out(system, i);
    count = gxsp_first_transfer(system, place, left_out, &transfer);
    if (gxsp_thin_crowded(system, scratch, place)) count = gxsp_first_transfer(system, place, left_out, &transfer);
    if (count == 0 || scratch->failed) return;
    gxsp_level_make(&system->multigrid.pool, fine + 1, count);
    if (system->multigrid.pool.failed) return;
    gxsp_transfer_places(fine, &transfer, fine + 1);
    gxsp_levels_make(system, scratch, NULL, NULL);
}

/* What levels have beside their pattern, where copies are affine */
static void gxsp_nested_end(gxsp_system *system, gxsp_pool *scratch) {
    gxsp_level *next = &system->multigrid.levels[1];
    gxsp_count_edges(system);
    system->multigrid.level_count = 2;
    next->block = (float *)gxsp_take(&system->multigrid.pool, gxsp_block_numbers(next), sizeof(float));
    system->affine.block = (double *)gxsp_take(&system->multigrid.pool, gxsp_block_numbers(next), sizeof(double));
    gxsp_factor_make(system, scratch);
}

/* Hidden nodes and offsets are to be found: memory for them. count: nodes */
static void gxsp_nested_begin(gxsp_system *system, uint32_t count) {
    gxsp_affine *affine = &system->affine;
    affine->hidden = (uint32_t *)gxsp_take(&system->multigrid.pool, count, sizeof(uint32_t));
    affine->offset = (float(*)[4][3])gxsp_take(&system->multigrid.pool, affine->group_count, sizeof *affine->offset);
    if (!system->multigrid.pool.failed) memset(affine->hidden, 0xff, count * sizeof *affine->hidden);
}

/* The same where copies are affine. Level 1 is factored, so its lattice is widened until that is cheap. */
static void gxsp_nested_make(gxsp_system *system, gxsp_pool *scratch, float (*place)[3]) {
    gxsp_level *next = &system->multigrid.levels[1];
    float(*own)[3] = (float(*)[3])gxsp_take(scratch, system->model.n, sizeof *own);
    uint8_t *left_out = (uint8_t *)gxsp_take(scratch, system->model.n, 1);
    gxsp_transfer transfer;
    gxsp_owned *mark;
    uint32_t count, i;
    float stretch;
    gxsp_edges_make(system, scratch);
    transfer.key = (uint64_t *)gxsp_take(scratch, 4 * system->model.n, sizeof(uint64_t));
    transfer.forest = (uint32_t *)gxsp_take(scratch, 4 * system->model.n, sizeof(uint32_t));
    mark = scratch->last;
    for (i = 0; i < system->model.n && left_out; i++)
        left_out[i] = gxsp_is_left_out(system, i) || gxsp_is_hidden(system, i);
    memcpy(system->affine.origin, system->model.positions, sizeof system->affine.origin);
    for (stretch = GXSP_NESTED_FROM;; stretch *= 1.25f) {
        if (scratch->failed) return;
        for (i = 0; i < 3 * system->model.n; i++) own[i / 3][i % 3] = place[i / 3][i % 3] / stretch;
        count = gxsp_first_transfer(system, own, left_out, &transfer);
        if (count == 0) return;
        gxsp_nested_begin(system, count);
        if (system->multigrid.pool.failed) return;
        gxsp_level_make(&system->multigrid.pool, next, gxsp_nested_nodes(system, count, count));
        if (system->multigrid.pool.failed) return;
        gxsp_transfer_places(&system->multigrid.levels[0], &transfer, next);
        system->affine.stretch = stretch;
        gxsp_nested_offsets(system);
        gxsp_pairs_make(system, scratch);
        if (!scratch->failed) gxsp_first_pattern(system, scratch, NULL, NULL);
        if (scratch->failed || system->multigrid.pool.failed) return;
        if (stretch > GXSP_WIDEST || gxsp_factors(scratch, next, GXSP_NESTED_COST * system->model.n)) break;
        gxsp_release_to(&system->multigrid.pool, NULL);
        gxsp_release_to(scratch, mark);
    }
    gxsp_nested_end(system, scratch);
}

/* >>lights: copies with next to no mass ---------------------------------------------------------------------------- */

/* In: chunks and row sums of masses. Out: the list of light copies: copies with only parts of elements around
 * them, nearly all of whose mass belongs to other copies. >>balance starts them where their neighbours lead,
 * >>search bounds their way. */

/* Masses around a copy, by which it is light or not */
typedef struct gxsp_weighed {
    gxsp_light light; /* in the lane with its heaviest neighbour */
    double all, most; /* mass of the elements around it; of the neighbour, kg */
    int whole;        /* an element around it is whole */
} gxsp_weighed;

static void gxsp_weigh_corner(const gxsp_system *system, uint32_t c, uint32_t lane, int corner, const uint32_t *copies,
                              gxsp_weighed *weighed) {
    const gxsp_chunk *chunk = &system->mesh.chunks[c];
    int k;
    weighed->whole |= !chunk->moments;
    weighed->all += chunk->rest[lane / GXSP_LANES].mass[lane % GXSP_LANES];
    for (k = 0; k < 4; k++)
        if (k != corner && system->model.lumped[copies[k]] > weighed->most) {
            weighed->most = system->model.lumped[copies[k]];
            weighed->light.copy = copies[corner], weighed->light.chunk = c;
            weighed->light.lane = (uint16_t)lane, weighed->light.corner = (uint16_t)corner;
        }
}

/* Weighs each copy, or each touched one. touched: n flags, or NULL: all */
static void gxsp_weigh_copies(const gxsp_system *system, const uint8_t *touched, gxsp_weighed *weighed) {
    uint32_t c, i, lane, copies[4];
    int k;
    for (c = 0; c < system->mesh.chunk_count; c++) {
        const gxsp_chunk *chunk = &system->mesh.chunks[c];
        for (i = 0; touched && i < chunk->node_count && !touched[system->mesh.nodes[chunk->first_node + i]]; i++)
            ;
        for (lane = 0; lane < chunk->block_count * GXSP_LANES && !(touched && i == chunk->node_count); lane++) {
            if (chunk->groups[lane] == GXSP_NONE) continue;
            gxsp_lane_copies(system, chunk, lane / GXSP_LANES, (int)(lane % GXSP_LANES), copies);
            for (k = 0; k < 4; k++)
                if (!touched || touched[copies[k]]) gxsp_weigh_corner(system, c, lane, k, copies, &weighed[copies[k]]);
        }
    }
}

static int gxsp_is_light(const gxsp_system *system, size_t copy, const gxsp_weighed *weighed) {
    const double mass = system->model.lumped[copy];
    return !weighed->whole && !system->model.fixed[copy] && weighed->most > 0 &&
           (mass < GXSP_LIGHT * weighed->all || mass < GXSP_LIGHTER * weighed->most);
}

/* Lists light copies. touched: n flags: other copies stay as they are listed; NULL: all are listed anew */
static void gxsp_list_lights(gxsp_system *system, gxsp_pool *scratch, const uint8_t *touched) {
    gxsp_weighed *weighed = (gxsp_weighed *)gxsp_take(scratch, system->model.n, sizeof *weighed);
    uint32_t i, count = 0, room;
    if (scratch->failed) return;
    gxsp_weigh_copies(system, touched, weighed);
    for (i = 0; i < system->model.light_count && touched; i++)
        if (!touched[system->model.lights[i].copy]) system->model.lights[count++] = system->model.lights[i];
    system->model.light_count = room = count;
    for (i = 0; i < system->model.n; i++) room += (uint32_t)gxsp_is_light(system, i, &weighed[i]);
    if (room > system->model.light_room) {
        system->model.light_room = (uint32_t)gxsp_room(room);
        system->model.lights = (gxsp_light *)gxsp_grow(&system->pool, system->model.lights, count,
                                                       system->model.light_room, sizeof(gxsp_light));
    }
    for (i = 0; i < system->model.n && !system->pool.failed; i++)
        if (gxsp_is_light(system, i, &weighed[i])) system->model.lights[system->model.light_count++] = weighed[i].light;
}

/* How far a light copy departs, in a vector x minus another one (or NULL), from the mean over the corners that guide
 * it, weighted by their masses; n x 3. Returns that as a share of its distance from the heaviest of these corners, at
 * rest or displaced by u, whichever is longer; without rest positions the distance counts as 0. back: leads to the
 * mean. */
static double gxsp_departure(const gxsp_system *system, const gxsp_light *light, const double *x, const double *minus,
                             const double *u, double back[3]) {
    const size_t copy = 3 * (size_t)light->copy;
    double sum = 0, most = 0, gap[3] = {0, 0, 0}, now[3] = {0, 0, 0};
    uint32_t copies[4];
    size_t heaviest = copy, c;
    int k;
    gxsp_lane_copies(system, &system->mesh.chunks[light->chunk], light->lane / GXSP_LANES, light->lane % GXSP_LANES,
                     copies);
    back[0] = back[1] = back[2] = 0;
    for (k = 0; k < 4; k++) {
        const size_t corner = 3 * (size_t)copies[k];
        const double mass = k == light->corner ? 0 : system->model.lumped[copies[k]];
        sum += mass;
        for (c = 0; c < 3; c++) back[c] += mass * (x[corner + c] - (minus ? minus[corner + c] : 0));
        if (mass > most) most = mass, heaviest = corner;
    }
    for (c = 0; c < 3; c++) back[c] = back[c] / sum - (x[copy + c] - (minus ? minus[copy + c] : 0));
    for (c = 0; c < 3 && system->model.positions; c++) {
        gap[c] = system->model.positions[copy + c] - system->model.positions[heaviest + c];
        now[c] = gap[c] + u[copy + c] - u[heaviest + c];
    }
    return sqrt(gxsp_dot(back, back, 1) / fmax(gxsp_dot(gap, gap, 1), gxsp_dot(now, now, 1)));
}

/* >>sharing: memory that passes and coarse numbers have in turn ---------------------------------------------------- */

/* In: sizes of the model and its levels. Out: arrays in gxsp_vectors.shared. Passes have it except between
 * gxsp_lend_memory and gxsp_return_memory. */

/* Arrays with which coarse numbers are made */
static void gxsp_numbers_carve(gxsp_system *system, gxsp_space *space) {
    gxsp_level *last = &system->multigrid.levels[system->multigrid.level_count - 1];
    if (!system->multigrid.fine) gxsp_edges_carve(system, space, 1);
    gxsp_pairs_carve(system, space, 1);
    if (system->multigrid.level_count > 2) /* level 1 keeps its own: updates make only part of it anew */
        last->block = (float *)gxsp_carve(space, gxsp_block_numbers(last), sizeof(float));
    system->multigrid.factor.rows = (double *)gxsp_carve(space, 3 * (size_t)system->multigrid.factor.n, sizeof(double));
}

/* Arrays of passes over chunks and of conjugate gradients */
static void gxsp_passes_carve(gxsp_system *system, gxsp_space *space) {
    system->vectors.slots = (double(*)[3])gxsp_carve(space, system->mesh.slot_count, sizeof *system->vectors.slots);
    system->vectors.search = (gxsp_vector4 *)gxsp_carve(space, system->model.n, sizeof(gxsp_vector4));
    system->vectors.product = (gxsp_vector4 *)gxsp_carve(space, system->model.n, sizeof(gxsp_vector4));
    system->vectors.scaled = (gxsp_vector4 *)gxsp_carve(space, system->model.n, sizeof(gxsp_vector4));
}

/* Shared memory goes back to passes. Its vectors become 0: their unused numbers take part in sums too. */
static void gxsp_return_memory(gxsp_system *system) {
    memset(system->vectors.search, 0, system->model.n * sizeof *system->vectors.search);
    memset(system->vectors.product, 0, system->model.n * sizeof *system->vectors.product);
    memset(system->vectors.scaled, 0, system->model.n * sizeof *system->vectors.scaled);
}

/* Makes shared memory large enough for passes and for coarse numbers, which have it in turn. */
static void gxsp_share_memory(gxsp_system *system) {
    gxsp_space passes = {NULL, 0}, numbers = {NULL, 0};
    size_t size;
    gxsp_passes_carve(system, &passes);
    if (system->multigrid.level_count > 0 && system->multigrid.fits) gxsp_numbers_carve(system, &numbers);
    size = passes.used > numbers.used ? passes.used : numbers.used;
    if (size > system->vectors.shared_room) {
        const size_t room = system->vectors.shared ? gxsp_room(size) : size;
        unsigned char *larger = (unsigned char *)gxsp_grow(&system->pool, system->vectors.shared, 0, room, 1);
        if (larger) {
            system->vectors.shared = larger;
            system->vectors.shared_room = room;
        } else if (passes.used > system->vectors.shared_room) {
            return;
        } /* else passes keep their memory, and the caller learns of the failure from the pool */
    }
    passes.memory = system->vectors.shared;
    passes.used = 0;
    gxsp_passes_carve(system, &passes);
    gxsp_return_memory(system);
}

/* What levels have beside their structure, once they are those of the present model */
static void gxsp_levels_end(gxsp_system *system) {
    system->multigrid.dirty = (uint8_t *)gxsp_take(&system->multigrid.pool, system->multigrid.levels[1].n, 1);
    system->multigrid.fits = 1;
    gxsp_share_memory(system);
}

/* All levels anew. spacing becomes 0 if there is nothing to coarsen. */
static void gxsp_make_levels(gxsp_system *system, gxsp_pool *scratch) {
    float(*place)[3] = (float(*)[3])gxsp_take(scratch, system->model.n, sizeof *place);
    const int known = place && gxsp_find_places(system, place);
    if (known && system->affine.count > 0)
        gxsp_nested_make(system, scratch, place);
    else if (known)
        gxsp_multigrid_make(system, scratch, place);
    if (scratch->failed || system->multigrid.pool.failed) return;
    if (system->multigrid.level_count > 0)
        gxsp_levels_end(system);
    else
        system->multigrid.spacing = 0;
}

/* Lends shared memory to the making of coarse numbers, until gxsp_return_memory. */
static void gxsp_lend_memory(gxsp_system *system) {
    gxsp_space space = {NULL, 0};
    space.memory = system->vectors.shared;
    gxsp_numbers_carve(system, &space);
    if (!system->multigrid.fine) {
        memset(system->multigrid.edges.table, 0,
               system->multigrid.edges.table_size * sizeof *system->multigrid.edges.table);
        memset(system->multigrid.edges.half, 0, system->multigrid.pairs.most * sizeof *system->multigrid.edges.half);
        memset(system->multigrid.pairs.stamp, 0, system->multigrid.levels[1].n * sizeof *system->multigrid.pairs.stamp);
        system->multigrid.pairs.round = 0;
    }
}

/* >>system: a model in the solver's own form ----------------------------------------------------------------------- */

/* In: the caller's model, already checked. Out: a gxsp_system, with all that does not depend on the state and the
 * memory of steps. */

/* 2^GXSP_STIFFNESS / (Young's modulus times the length of the largest element), rounded to a power of two */
static double gxsp_choose_scale(const gxs_model *model) {
    double young = 0, volume = 0, size;
    size_t i;
    int exponent;
    for (i = 0; i < model->material_count; i++)
        young = model->materials[i].young > young ? model->materials[i].young : young;
    for (i = 0; i < model->element_count; i++)
        volume = model->elements[i].weight > volume ? model->elements[i].weight : volume;
    size = volume > 0 ? young * cbrt(volume) : young;
    (void)frexp(size, &exponent);
    return ldexp(1, GXSP_STIFFNESS - exponent);
}

/* Inverse volumes of supports; the least is about the inverse stiffness of a whole copy */
static void gxsp_find_volumes(gxsp_system *system, gxsp_pool *scratch, const gxs_model *model) {
    double *volume = (double *)gxsp_take(scratch, system->model.n, sizeof(double)), largest = 0;
    size_t e, i;
    int k;
    system->model.volume = (float *)gxsp_take(&system->pool, system->model.n, sizeof(float));
    if (system->pool.failed || scratch->failed) return;
    for (e = 0; e < model->element_count; e++)
        for (k = 0; k < 4; k++) volume[model->elements[e].copy[k]] += model->elements[e].weight;
    for (i = 0; i < system->model.n; i++) largest = volume[i] > largest ? volume[i] : largest;
    for (i = 0; i < system->model.n; i++)
        system->model.volume[i] = volume[i] > 1e-20 * largest ? (float)ldexp(largest / volume[i], -GXSP_STIFFNESS) : 0;
}

/* A component is large enough for multigrid from this many copies on. */
static uint32_t gxsp_large(const gxsp_system *system) {
    return system->model.stiff || system->affine.count > 0 ? GXSP_MULTIGRID_FROM_STIFF : GXSP_MULTIGRID_FROM;
}

/* Is a component large enough for multigrid? All components take as many iterations as the slowest one. count:
 * component_count, scratch */
static int gxsp_large_component(const gxsp_system *system, uint32_t *count) {
    const uint32_t from = gxsp_large(system);
    size_t i;
    memset(count, 0, system->model.component_count * sizeof *count);
    for (i = 0; i < system->model.n; i++)
        if (++count[system->model.component[i]] >= from) return 1;
    return 0;
}

/* Everything that depends on the choice of matrix and preconditioner. forest: n, scratch */
static void gxsp_preconditioner_make(gxsp_system *system, gxsp_pool *scratch, const gxs_model *model,
                                     gxs_preconditioner preconditioner, gxs_matrix matrix, uint32_t *forest) {
    const int multigrid =
        model->positions &&
        (preconditioner == GXS_MULTIGRID || (preconditioner == GXS_AUTOMATIC && gxsp_large_component(system, forest)));
    system->multigrid.chosen = model->positions && preconditioner == GXS_AUTOMATIC;
    if (preconditioner == GXS_VOLUME_RATIO) gxsp_find_volumes(system, scratch, model);
    system->multigrid.levels[0].n = (uint32_t)system->model.n;
    if (matrix == GXS_MATRIX_ASSEMBLED) gxsp_fine_make(system, scratch);
    if (!multigrid) return;
    system->multigrid.spacing = gxsp_find_spacing(model);
    gxsp_transfer_make(&system->pool, &system->multigrid.levels[0]);
}

/* Everything about a model that does not depend on its state. scratch: for temporary memory. Returns the index of a
 * constraint that is not allowed, or SIZE_MAX. */
static size_t gxsp_system_build(gxsp_system *system, gxsp_pool *scratch, const gxs_model *model,
                                const gxs_solver *solver) {
    uint32_t i, *forest = (uint32_t *)gxsp_take(scratch, model->copy_count, sizeof(uint32_t));
    gxs_model plain = *model; /* without the elements of affine copies */
    gxsp_owned *mark;
    size_t bad;
    system->model.n = model->copy_count;
    system->model.epoch = model->epoch;
    system->model.element_count = model->element_count;
    system->model.range_count = (system->model.n + GXSP_RANGE - 1) / GXSP_RANGE;
    system->model.lumped_mass = model->lumped_mass != 0;
    system->model.scale = gxsp_choose_scale(model);
    system->coarse.rate = system->state.product_rate = -1;
    system->coarse.life = GXSP_LIFE;
    system->model.material_count = (uint32_t)model->material_count;
    system->model.materials = (gxsp_material *)gxsp_take(&system->pool, model->material_count, sizeof(gxsp_material));
    system->state.damped = (gxsp_material *)gxsp_take(&system->pool, model->material_count, sizeof(gxsp_material));
    gxsp_copies_make(system, model->positions);
    if (model->affine && !system->pool.failed) gxsp_groups_begin(system, model);
    if (scratch->failed || system->pool.failed) return SIZE_MAX;
    for (i = 0; i < system->model.material_count; i++) {
        system->state.damped[i] = system->model.materials[i] = gxsp_material_make(&model->materials[i]);
        system->model.damps |= model->materials[i].damping > 0;
        system->model.stiff |=
            model->materials[i].kind != GXS_CUSTOM && model->materials[i].poisson > GXSP_STIFF_POISSON;
    }
    gxsp_find_fixed(system, model);
    bad = gxsp_bad_constraint(model->constraints, model->constraint_count, model->held, system->state.still);
    if (bad == SIZE_MAX) gxsp_set_followers(system, model->constraints, model->constraint_count);
    if (bad != SIZE_MAX || system->pool.failed) return bad;
    memcpy(system->state.still, system->model.fixed, system->model.n);
    gxsp_join_copies(system, model, forest);
    gxsp_number_components(system, forest);
    system->model.components =
        (gxsp_component *)gxsp_take(&system->pool, system->model.component_count, sizeof(gxsp_component));
    if (system->pool.failed) return SIZE_MAX;
    gxsp_fill_components(system);
    mark = scratch->last;
    if (system->affine.group_count > 0) gxsp_affine_make(system, scratch, model, &plain);
    if (scratch->failed || system->pool.failed) return SIZE_MAX;
    gxsp_chunks_make(system, scratch, &plain);
    if (!scratch->failed && !system->pool.failed) gxsp_partials_make(system);
    if (!scratch->failed && !system->pool.failed) gxsp_list_lights(system, scratch, NULL);
    gxsp_release_to(scratch, mark);
    if (!scratch->failed && !system->pool.failed)
        gxsp_preconditioner_make(system, scratch, model, solver->preconditioner, solver->matrix, forest);
    return SIZE_MAX;
}

/* Takes the memory that only steps need: last, when temporary memory has been given back */
static void gxsp_steps_make(gxsp_system *system) {
    const size_t n = system->model.n;
    gxsp_vectors *vectors = &system->vectors;
    gxsp_columns_make(system, GXSP_COLUMNS(gxsp_copy_columns), GXSP_FOR_STEPS, n);
    if (system->multigrid.spacing > 0)
        system->coarse.displacement = (double *)gxsp_take(&system->pool, n, 3 * sizeof(double));
    if (system->model.damps) vectors->damping = (double *)gxsp_take(&system->pool, n, 3 * sizeof(double));
    if (system->multigrid.fine) vectors->right = (gxsp_vector4 *)gxsp_take(&system->pool, n, sizeof(gxsp_vector4));
    vectors->range_sum =
        (double(*)[GXSP_SUMS])gxsp_take(&system->pool, system->model.range_count, sizeof *vectors->range_sum);
    gxsp_share_memory(system);
    gxsp_tangents_make(&system->pool, system->mesh.chunks, system->mesh.chunk_count);
}

static void gxsp_system_destroy(gxsp_system *system) {
    gxsp_pool pool;
    if (!system) return;
    gxsp_release_to(&system->multigrid.pool, NULL);
    gxsp_release_to(&system->leap.pool, NULL);
    pool = system->pool; /* the pool also holds the system itself */
    gxsp_release_to(&pool, NULL);
}

static void gxsp_drop_system(gxs_solver *solver) {
    gxsp_system_destroy(solver->system);
    solver->system = NULL;
}

/* >>rule: passes over elements with affine copies ------------------------------------------------------------------ */

/* In: vectors over copies. Out: energies, forces, Hessians, products, diagonal blocks. The field of an element is
 *   u = sum N_i (a_i + A_i (x - X_i)) = sum N_j a_j + sum 4 N_i N_j e_ij over pairs,
 *   e_ij = (A_i - A_j)(X_j - X_i) / 4.
 * So its gradient at a point is that of a linear element whose corners have moved by w_j = a_j + sum 4 N_i e_ij
 * over i. At each of four points the passes of >>element serve. u there is sum N_j (a_j + w_j) / 2. A task writes its
 * own block and the slots of it. */

/* Vectors of a block's elements: [3 vector + axis]; 0 where there is none */
static void gxsp_affine_gather(const gxsp_affine_block *block, const double *x, gxsp_lanes *to) {
    int k, l, r;
    for (k = 0; k < 16; k++)
        for (l = 0; l < GXSP_LANES; l++)
            for (r = 0; r < 3; r++)
                to[3 * k + r][l] =
                    block->vector[k][l] == GXSP_NONE ? 0 : x[3 * (size_t)block->vector[k][l] + (size_t)r];
}

static void gxsp_affine_scatter(gxsp_lanes *GXSP_RESTRICT from, double (*GXSP_RESTRICT slots)[3]) {
    int k, l, r;
    for (k = 0; k < 16; k++)
        for (l = 0; l < GXSP_LANES; l++)
            for (r = 0; r < 3; r++) slots[k * GXSP_LANES + l][r] = from[3 * k + r][l];
}

/* (X_j - X_i) / (4 length) of an edge, axis a */
GXSP_INLINE double gxsp_affine_edge(const gxsp_affine_block *block, int edge, int a, int l) {
    const int i = gxsp_edge_ends[edge][0], j = gxsp_edge_ends[edge][1];
    return block->edge[3 * (j - 1) + a][l] - (i > 0 ? block->edge[3 * (i - 1) + a][l] : 0);
}

/* e_ij of the six edges: [3 edge + axis] */
static void gxsp_affine_bend(const gxsp_affine_block *block, gxsp_lanes *GXSP_RESTRICT x, gxsp_lanes *GXSP_RESTRICT e) {
    int k, r, l;
    for (k = 0; k < 6; k++) {
        gxsp_lanes *p = x + 12 + 9 * gxsp_edge_ends[k][0], *q = x + 12 + 9 * gxsp_edge_ends[k][1];
        gxsp_lanes way[3];
        for (r = 0; r < 3; r++) GXSP_EACH_LANE(l) way[r][l] = gxsp_affine_edge(block, k, r, l);
        for (r = 0; r < 3; r++) GXSP_EACH_LANE(l)
        e[3 * k + r][l] = (p[r][l] - q[r][l]) * way[0][l] + (p[3 + r][l] - q[3 + r][l]) * way[1][l] +
                          (p[6 + r][l] - q[6 + r][l]) * way[2][l];
    }
}

/* w of the corners at a point */
static void gxsp_affine_corners(const gxsp_affine_block *block, int point, gxsp_lanes *GXSP_RESTRICT x,
                                gxsp_lanes *GXSP_RESTRICT e, gxsp_lanes *GXSP_RESTRICT w) {
    int k, r, l;
    memcpy(w, x, 12 * sizeof *w);
    for (k = 0; k < 6; k++) {
        const int i = gxsp_edge_ends[k][0], j = gxsp_edge_ends[k][1];
        for (r = 0; r < 3; r++) GXSP_EACH_LANE(l) {
                w[3 * j + r][l] += 4 * block->shape[point][i][l] * e[3 * k + r][l];
                w[3 * i + r][l] += 4 * block->shape[point][j][l] * e[3 * k + r][l];
            }
    }
}

/* Forces on w at a point, to those on a and e */
static void gxsp_affine_collect(const gxsp_affine_block *block, int point, gxsp_lanes *GXSP_RESTRICT w,
                                gxsp_lanes *GXSP_RESTRICT y, gxsp_lanes *GXSP_RESTRICT e) {
    int k, r, l;
    for (k = 0; k < 12; k++) GXSP_EACH_LANE(l) y[k][l] += w[k][l];
    for (k = 0; k < 6; k++) {
        const int i = gxsp_edge_ends[k][0], j = gxsp_edge_ends[k][1];
        for (r = 0; r < 3; r++) GXSP_EACH_LANE(l)
        e[3 * k + r][l] +=
            4 * (block->shape[point][i][l] * w[3 * j + r][l] + block->shape[point][j][l] * w[3 * i + r][l]);
    }
}

/* Forces on e, to those on hidden vectors */
static void gxsp_affine_return(const gxsp_affine_block *block, gxsp_lanes *GXSP_RESTRICT e,
                               gxsp_lanes *GXSP_RESTRICT y) {
    int k, r, a, l;
    for (k = 0; k < 6; k++) {
        gxsp_lanes *p = y + 12 + 9 * gxsp_edge_ends[k][0], *q = y + 12 + 9 * gxsp_edge_ends[k][1];
        for (a = 0; a < 3; a++)
            for (r = 0; r < 3; r++) GXSP_EACH_LANE(l) {
                    const double force = e[3 * k + r][l] * gxsp_affine_edge(block, k, a, l);
                    p[3 * a + r][l] += force;
                    q[3 * a + r][l] -= force;
                }
    }
}

/* Adds rate M x of a point to forces on a and e; energy += rate/2 x M x. */
static void gxsp_affine_inertia(const gxsp_affine_block *block, int point, double rate, gxsp_lanes *GXSP_RESTRICT x,
                                gxsp_lanes *GXSP_RESTRICT w, gxsp_lanes *GXSP_RESTRICT y, gxsp_lanes *GXSP_RESTRICT e,
                                double *GXSP_RESTRICT energy) {
    gxsp_lanes force;
    int k, r, j, l;
    for (r = 0; r < 3; r++) {
        GXSP_EACH_LANE(l) {
            const double at = 0.5 * (block->shape[point][0][l] * (x[r][l] + w[r][l]) +
                                     block->shape[point][1][l] * (x[3 + r][l] + w[3 + r][l]) +
                                     block->shape[point][2][l] * (x[6 + r][l] + w[6 + r][l]) +
                                     block->shape[point][3][l] * (x[9 + r][l] + w[9 + r][l]));
            force[l] = rate * block->rest.mass[l] * at;
            energy[l] += 0.5 * force[l] * at;
        }
        for (j = 0; j < 4; j++) GXSP_EACH_LANE(l) y[3 * j + r][l] += block->shape[point][j][l] * force[l];
        for (k = 0; k < 6; k++) GXSP_EACH_LANE(l)
        e[3 * k + r][l] +=
            4 * block->shape[point][gxsp_edge_ends[k][0]][l] * block->shape[point][gxsp_edge_ends[k][1]][l] * force[l];
    }
}

/* What the points of a block share: x and what is subtracted from it or ahead of it, with their bends, and the sums of
 * forces on vectors and bends */
typedef struct gxsp_affine_sums {
    gxsp_lanes x[48], other[48], bend[18], bend_other[18], y[48], forces[18];
} gxsp_affine_sums;

/* The share of one point in energies and forces of a block */
static GXSP_APART void gxsp_affine_point(const gxsp_pass *pass, gxsp_affine_block *block, int p,
                                         gxsp_affine_sums *sums) {
    gxsp_lanes w[12], w_other[12], ahead[9], own[12];
    gxsp_state s;
    int l;
    gxsp_affine_corners(block, p, sums->x, sums->bend, w);
    if (pass->inertia || pass->rotated) gxsp_affine_corners(block, p, sums->other, sums->bend_other, w_other);
    gxsp_block_parameters(pass->materials, &block->rest, &s);
    gxsp_block_gradient(block->gradient, w, s.g);
    if (pass->rotated) gxsp_block_gradient(block->gradient, w_other, ahead);
    if (pass->nudge && block->kind != GXS_LINEAR && block->kind != GXS_CUSTOM) gxsp_nudge(s.g);
    gxsp_material_state(block->kind, &s);
    if (pass->rotated && block->kind != GXS_LINEAR) gxsp_rotate_stress(s.g, ahead, s.p);
    memset(own, 0, sizeof own);
    gxsp_block_force(block->rest.weight, block->gradient, s.p, own);
    gxsp_affine_collect(block, p, own, sums->y, sums->forces);
    for (l = 0; l < GXSP_LANES; l++) {
        block->energies[0][l] += block->rest.weight[l] * s.energy[l];
        block->energies[2][l] += block->rest.weight[l] * s.size[l];
    }
    if (pass->inertia)
        gxsp_affine_inertia(block, p, pass->rate, sums->other, w_other, sums->y, sums->forces, block->energies[1]);
}

/* Energies and forces of a block: see gxsp_task_state */
static GXSP_APART void gxsp_affine_state(const gxsp_pass *pass, gxsp_affine_block *block, double (*slots)[3]) {
    const int led = pass->inertia || pass->rotated; /* never both */
    gxsp_affine_sums sums;
    int p, k, l;
    gxsp_affine_gather(block, pass->from, sums.x);
    gxsp_affine_bend(block, sums.x, sums.bend);
    if (led) gxsp_affine_gather(block, pass->inertia ? pass->system->vectors.target : pass->rotated, sums.other);
    for (k = 0; k < 48 && pass->inertia; k++) GXSP_EACH_LANE(l) sums.other[k][l] = sums.x[k][l] - sums.other[k][l];
    if (led) gxsp_affine_bend(block, sums.other, sums.bend_other);
    memset(sums.y, 0, sizeof sums.y);
    memset(sums.forces, 0, sizeof sums.forces);
    memset(block->energies, 0, sizeof block->energies);
    for (p = 0; p < 4; p++) gxsp_affine_point(pass, block, p, &sums);
    for (l = 0; l < GXSP_LANES; l++) block->energies[2][l] += block->energies[1][l];
    gxsp_affine_return(block, sums.forces, sums.y);
    gxsp_affine_scatter(sums.y, slots);
}

/* Hessian of a block at pass->from, point by point */
static GXSP_APART void gxsp_affine_tangents(const gxsp_pass *pass, gxsp_affine_block *block) {
    gxsp_lanes x[48], bend[18], w[12];
    gxsp_state s;
    gxsp_svd svd;
    int p;
    block->collapsed = 0;
    gxsp_affine_gather(block, pass->from, x);
    gxsp_affine_bend(block, x, bend);
    for (p = 0; p < 4; p++) {
        gxsp_affine_corners(block, p, x, bend, w);
        gxsp_block_parameters(pass->materials, &block->rest, &s);
        gxsp_block_gradient(block->gradient, w, s.g);
        block->collapsed |= (uint8_t)gxsp_tangent_begin(block->kind, &s, NULL, &svd);
        gxsp_tangent_make(block->kind, &block->rest, block->gradient, pass->system->model.scale, pass->exact, &s, &svd,
                          &block->tangent[p], block->general ? &block->general[p] : NULL);
    }
}

/* The product of a block with x, into its slots. pass->rate: times scale */
static GXSP_APART void gxsp_affine_product(const gxsp_pass *pass, const gxsp_affine_block *block, gxsp_lanes *x,
                                           double (*slots)[3]) {
    gxsp_lanes y[48], bend[18], forces[18], w[12], energy;
    int p, k, l;
    gxsp_affine_bend(block, x, bend);
    memset(y, 0, sizeof y);
    memset(forces, 0, sizeof forces);
    GXSP_EACH_LANE(l) energy[l] = 0;
    for (p = 0; p < 4; p++) {
        gxsp_singles from[12], to[12];
        gxsp_affine_corners(block, p, x, bend, w);
        if (pass->rate > 0) gxsp_affine_inertia(block, p, pass->rate, x, w, y, forces, energy);
        for (k = 0; k < 12; k++) GXSP_EACH_LANE(l) {
                from[k][l] = k < 3 ? 0 : (float)(w[k][l] - w[k % 3][l]);
                to[k][l] = 0;
            }
        gxsp_kind_product(block->kind, &block->tangent[p], NULL, block->general ? &block->general[p] : NULL, 1, from,
                          to);
        for (k = 0; k < 12; k++) GXSP_EACH_LANE(l) w[k][l] = (double)to[k][l];
        gxsp_affine_collect(block, p, w, y, forces);
    }
    gxsp_affine_return(block, forces, y);
    gxsp_affine_scatter(y, slots);
}

/* What a task does with its blocks */
static void gxsp_affine_over(void *context, size_t index, int what) {
    const gxsp_pass *pass = (const gxsp_pass *)context;
    gxsp_affine *affine = &pass->system->affine;
    const size_t first = affine->round + index * GXSP_AFFINE_TASK, end = first + GXSP_AFFINE_TASK;
    gxsp_lanes x[48];
    size_t b;
    int k, l, r;
    for (b = first; b < end && b < affine->block_count; b++) {
        gxsp_affine_block *block = &affine->blocks[b];
        double(*slots)[3] = affine->slots + (b - affine->round) * 16 * GXSP_LANES;
        if (block->still) {
            memset(block->energies, 0, sizeof block->energies);
            block->collapsed = 0;
        } else if (what == 0)
            gxsp_affine_state(pass, block, slots);
        else if (what == 1)
            gxsp_affine_tangents(pass, block);
        else {
            for (k = 0; k < 16; k++)
                for (l = 0; l < GXSP_LANES; l++) {
                    const uint32_t vector = block->vector[k][l];
                    double in[3] = {0, 0, 0};
                    if (vector != GXSP_NONE) gxsp_copy_direction(pass, vector, in);
                    for (r = 0; r < 3; r++) x[3 * k + r][l] = in[r];
                }
            gxsp_affine_product(pass, block, x, slots);
        }
    }
}

static void gxsp_task_affine_state(void *context, size_t index) { gxsp_affine_over(context, index, 0); }
static void gxsp_task_affine_tangents(void *context, size_t index) { gxsp_affine_over(context, index, 1); }
static void gxsp_task_affine_product(void *context, size_t index) { gxsp_affine_over(context, index, 2); }

/* Adds the results of a round to those of vectors. */
static void gxsp_affine_add(const gxsp_affine *affine, uint32_t end, double *sum) {
    uint32_t b;
    int k, l, r;
    for (b = affine->round; b < end; b++) {
        const gxsp_affine_block *block = &affine->blocks[b];
        double(*slots)[3] = affine->slots + (b - affine->round) * 16 * GXSP_LANES;
        for (k = 0; k < 16 && !block->still; k++)
            for (l = 0; l < GXSP_LANES; l++)
                for (r = 0; r < 3 && block->vector[k][l] != GXSP_NONE; r++)
                    sum[3 * (size_t)block->vector[k][l] + (size_t)r] += slots[k * GXSP_LANES + l][r];
    }
}

/* A pass over all blocks, round after round. sum: n x 3, to which results are added; NULL: there are none */
static void gxsp_over_affine(gxsp_system *system, void (*task)(void *, size_t), gxsp_pass *pass, double *sum) {
    gxsp_affine *affine = &system->affine;
    pass->system = system;
    for (affine->round = 0; affine->round < affine->block_count; affine->round += GXSP_AFFINE_ROUND) {
        const uint32_t left = affine->block_count - affine->round,
                       count = left < GXSP_AFFINE_ROUND ? left : GXSP_AFFINE_ROUND;
        gxsp_parallel(system->jobs, (count + GXSP_AFFINE_TASK - 1) / GXSP_AFFINE_TASK, task, pass);
        if (sum) gxsp_affine_add(affine, affine->round + count, sum);
    }
}

/* Adds forces and energies to those of chunks. */
static void gxsp_affine_evaluate(gxsp_system *system, gxsp_pass *pass) {
    const gxsp_affine *affine = &system->affine;
    uint32_t b;
    int k, l;
    gxsp_over_affine(system, gxsp_task_affine_state, pass, pass->sum);
    for (b = 0; b < affine->block_count; b++)
        for (l = 0; l < GXSP_LANES; l++)
            for (k = 0; k < 3 && affine->blocks[b].vector[0][l] != GXSP_NONE; k++)
                gxsp_lead_of(system, affine->blocks[b].vector[0][l])->energies[k] += affine->blocks[b].energies[k][l];
}

/* A function of an element is given by its share of each vector. At a point its gradient is that of a linear function
 * with the values w at the corners. */
static void gxsp_point_corners(const gxsp_affine_block *block, int point, int l, const double share[16], double w[4]) {
    int k, j, a;
    for (j = 0; j < 4; j++) w[j] = share[j];
    for (k = 0; k < 6; k++) {
        const int i = gxsp_edge_ends[k][0];
        double e = 0;
        j = gxsp_edge_ends[k][1];
        for (a = 0; a < 3; a++) e += (share[4 + 3 * i + a] - share[4 + 3 * j + a]) * gxsp_affine_edge(block, k, a, l);
        w[j] += 4 * block->shape[point][i][l] * e;
        w[i] += 4 * block->shape[point][j][l] * e;
    }
}

/* A function of an element at a point: gradient in the frame of V, and value */
static void gxsp_point_function(const gxsp_affine_block *block, int point, int l, const double share[16],
                                double gradient[3], double *value) {
    const gxsp_tangent *tangent = &block->tangent[point];
    double w[4];
    int j, a;
    gxsp_point_corners(block, point, l, share, w);
    for (j = 0, *value = 0; j < 4; j++) *value += 0.5 * block->shape[point][j][l] * (share[j] + w[j]);
    for (a = 0; a < 3; a++) {
        gradient[a] = 0;
        for (j = 1; j < 4; j++) gradient[a] += (w[j] - w[0]) * (double)tangent->gradient[3 * (j - 1) + a][l];
    }
}

/* Its gradient in the material's frame */
static void gxsp_point_gradient(const gxsp_affine_block *block, int point, int l, const double share[16],
                                double gradient[3]) {
    double w[4];
    int j, a;
    gxsp_point_corners(block, point, l, share, w);
    for (a = 0; a < 3; a++)
        for (gradient[a] = 0, j = 1; j < 4; j++) gradient[a] += (w[j] - w[0]) * block->gradient[3 * (j - 1) + a][l];
}

/* slack[i]: its part of A_i less its gradient, 1/m, where corner i is affine, else 0. length: see gxsp_affine */
static void gxsp_point_slack(const gxsp_affine_block *block, double length, int point, int l, const double share[16],
                             float slack[4][3]) {
    double gradient[3];
    int i, a;
    gxsp_point_gradient(block, point, l, share, gradient);
    for (i = 0; i < 4; i++)
        for (a = 0; a < 3; a++)
            slack[i][a] =
                block->vector[4 + 3 * i][l] == GXSP_NONE ? 0 : (float)(share[4 + 3 * i + a] / length - gradient[a]);
}

/* flux[9 s + 3 r + m] = weight x dP_rm, in the frame of V, when dF is the gradient of a function in direction s */
static void gxsp_point_flux(const gxsp_affine_block *block, int point, int l, const double gradient[3],
                            double flux[27]) {
    const gxsp_tangent *t = &block->tangent[point];
    int s, r, m, n;
    double u[9];
    if (block->general) {
        for (s = 0; s < 3; s++)
            for (r = 0; r < 3; r++)
                for (m = 0; m < 3; m++)
                    for (n = 0, flux[9 * s + 3 * r + m] = 0; n < 3; n++)
                        flux[9 * s + 3 * r + m] +=
                            (double)block->general[point].hessian[gxsp_packed9(3 * r + m, 3 * s + n)][l] * gradient[n];
        return;
    }
    {
        const double a = (double)t->frame[0][l], b = (double)t->frame[1][l], c = (double)t->frame[2][l],
                     d = (double)t->frame[3][l];
        u[0] = 1 - (b * b + c * c), u[1] = a * b - c * d, u[2] = a * c + b * d;
        u[3] = a * b + c * d, u[4] = 1 - (a * a + c * c), u[5] = b * c - a * d;
        u[6] = a * c - b * d, u[7] = b * c + a * d, u[8] = 1 - (a * a + b * b);
    }
    for (s = 0; s < 3; s++) {
        double f[9], p[9];
        for (r = 0; r < 9; r++) f[r] = u[3 * s + r / 3] * gradient[r % 3];
        for (r = 0; r < 3; r++) {
            p[4 * r] = 0;
            for (m = 0; m < 3; m++)
                p[4 * r] += (double)t->stretch[gxsp_packed3(r < m ? r : m, r < m ? m : r)][l] * f[4 * m];
            for (m = 0; m < 3; m++)
                if (m != r)
                    p[3 * r + m] =
                        (double)t->even[3 - r - m][l] * f[3 * r + m] + (double)t->odd[3 - r - m][l] * f[3 * m + r];
        }
        for (r = 0; r < 3; r++)
            for (m = 0; m < 3; m++)
                flux[9 * s + 3 * r + m] = u[3 * r] * p[m] + u[3 * r + 1] * p[3 + m] + u[3 * r + 2] * p[6 + m];
    }
}

/* to[3 r + s] += gradient . flux, the block in the row of one function and the column of another */
static void gxsp_point_couple(const double gradient[3], const double flux[27], double to[9]) {
    int k;
    for (k = 0; k < 9; k++) {
        const double *p = flux + 9 * (k % 3) + 3 * (k / 3);
        to[k] += gradient[0] * p[0] + gradient[1] * p[1] + gradient[2] * p[2];
    }
}

/* Mean stiffness at a point, weight x N/m2: a ninth of the trace of the tangent */
static double gxsp_point_modulus(const gxsp_affine_block *block, int point, int l) {
    double sum[9] = {0, 0, 0, 0, 0, 0, 0, 0, 0}, flux[27];
    int a;
    for (a = 0; a < 3; a++) {
        double gradient[3] = {0, 0, 0};
        gradient[a] = 1;
        gxsp_point_flux(block, point, l, gradient, flux);
        gxsp_point_couple(gradient, flux, sum);
    }
    return (sum[0] + sum[4] + sum[8]) / 9;
}

/* Adds weight x a function to the shares of node's one, which it lists if it is new. Returns how many are listed. */
static uint32_t gxsp_add_function(uint32_t *node, double (*share)[16], uint32_t count, uint32_t to, uint32_t function,
                                  double weight) {
    uint32_t c;
    for (c = 0; c < count && node[c] != to; c++) {}
    if (c == count) {
        memset(share[c], 0, sizeof share[c]);
        node[count++] = to;
    }
    share[c][function] += weight;
    return count;
}

/* Adds a block of two parts of a group, or of a copy, to the diagonal. p, q: in the order of their parts */
static void gxsp_add_own(gxsp_affine *affine, uint32_t p, uint32_t q, const double block[9]) {
    static const int packed[6] = {0, 1, 2, 4, 5, 8};
    const uint32_t place = affine->place[p];
    int k;
    for (k = 0; k < 6 && place == GXSP_NONE; k++) affine->own[p][k] += block[packed[k]];
    for (k = 0; k < 9 && place != GXSP_NONE; k++)
        affine->full[place / 4][gxsp_packed_mass[place & 3][affine->place[q] & 3]][k] += block[k];
}

/* Do two vectors share a diagonal block, with the parts of a group in order? */
static int gxsp_is_own(const gxsp_affine *affine, uint32_t p, uint32_t q) {
    const uint32_t a = affine->place[p], b = affine->place[q];
    return p == q || (a != GXSP_NONE && b != GXSP_NONE && a / 4 == b / 4 && a < b);
}

/* Diagonal blocks of one element: of the vectors that move it. Where corners follow, those are their masters. */
static void gxsp_affine_element_blocks(gxsp_system *system, const gxsp_affine_block *block, int l, double rate) {
    uint32_t node[64], masters[16], count = 0, c, d, k;
    double share[64][16], gradient[64][3], value[64], flux[27];
    float weights[16];
    int p, n;
    for (k = 0; k < 16; k++) {
        n = block->vector[k][l] == GXSP_NONE ? 0 : gxsp_masters_of(system, block->vector[k][l], masters, weights);
        while (n-- > 0) count = gxsp_add_function(node, share, count, masters[n], k, (double)weights[n]);
    }
    for (p = 0; p < 4; p++) {
        for (c = 0; c < count; c++) gxsp_point_function(block, p, l, share[c], gradient[c], &value[c]);
        for (d = 0; d < count; d++) {
            gxsp_point_flux(block, p, l, gradient[d], flux);
            for (c = 0; c < count; c++) {
                double to[9] = {0, 0, 0, 0, 0, 0, 0, 0, 0};
                const double mass = rate * block->rest.mass[l] * value[c] * value[d];
                if (!gxsp_is_own(&system->affine, node[c], node[d])) continue;
                gxsp_point_couple(gradient[c], flux, to);
                to[0] += mass, to[4] += mass, to[8] += mass;
                gxsp_add_own(&system->affine, node[c], node[d], to);
            }
        }
    }
}

/* A term's share in the diagonal block of a copy, as a factor of its Hessian. The square of the weight is too little
 * for the smoother where a term joins many copies, as those of a pair. Its sum over a row is a bound of the whole
 * matrix. */
static inline float gxsp_diagonal_share(const gxsp_term *term, float weight) {
    return term->spread > 0 ? term->spread * fabsf(weight) : weight * weight;
}

/* What moves the vectors of a term: those that follow none, with their weights. Returns how many. */
static uint32_t gxsp_term_masters(const gxsp_system *system, const gxsp_term *term, uint32_t *node, float *weight) {
    const gxsp_share *share = system->lasting->share + term->first, *end = share + term->count;
    uint32_t masters[16], count = 0, i;
    float weights[16];
    int n;
    for (; share < end; share++)
        for (n = gxsp_masters_of(system, share->copy, masters, weights); n-- > 0;) {
            for (i = 0; i < count && node[i] != masters[n]; i++) {}
            if (i == count) node[count] = masters[n], weight[count++] = 0;
            weight[i] += share->weight * weights[n];
        }
    return count;
}

/* A term in the diagonal blocks of what moves it. Those of a pair bound the whole matrix, see gxsp_diagonal_share: for
 * the block of a group the sum of its weights' sizes stands for the weight of a copy. */
static void gxsp_affine_term(gxsp_system *system, const gxsp_term *term) {
    static const int full[9] = {0, 1, 2, 1, 3, 4, 2, 4, 5};
    uint32_t node[16 * GXS_POINT_MOST], count, i, j;
    float weight[16 * GXS_POINT_MOST], spread = 0;
    int k;
    count = gxsp_term_masters(system, term, node, weight);
    for (i = 0; i < count && term->spread > 0; i++) spread += fabsf(weight[i]);
    for (i = 0; i < count; i++) {
        const uint32_t place = system->affine.place[node[i]];
        float size = 0, factor;
        for (j = 0; j < count; j++)
            if (node[j] == node[i] || (place != GXSP_NONE && system->affine.place[node[j]] / 4 == place / 4))
                size += fabsf(weight[j]);
        factor = spread > 0 && size > 0 ? spread / size : 1;
        for (j = 0; j < count; j++) {
            double block[9];
            if (!gxsp_is_own(&system->affine, node[i], node[j])) continue;
            for (k = 0; k < 9; k++) block[k] = (double)(factor * weight[i] * weight[j] * term->hessian[full[k]]);
            gxsp_add_own(&system->affine, node[i], node[j], block);
        }
    }
}

/* W of a group: the inverse of its 12x12 block is W^T W, semi-definite in spite of rounding. 1e-7 of the diagonal is
 * added, as in gxsp_invert3. */
static void gxsp_affine_invert(const gxsp_system *system, uint32_t group) {
    const gxsp_affine *affine = &system->affine;
    double a[12][12], scale[12], w[12][12];
    int i, j, k;
    for (i = 0; i < 12; i++)
        for (j = 0; j < 12; j++) {
            const int p = i / 3 < j / 3 ? i / 3 : j / 3, q = i / 3 < j / 3 ? j / 3 : i / 3;
            const double *from = affine->full[group][gxsp_packed_mass[p][q]];
            a[i][j] = i / 3 <= j / 3 ? from[3 * (i % 3) + j % 3] : from[3 * (j % 3) + i % 3];
        }
    for (i = 0; i < 12; i++)
        scale[i] = !system->state.still[affine->member[group][i / 3]] &&
                           !gxsp_follows(system, affine->member[group][i / 3]) && a[i][i] > GXSP_TINY
                     ? 1 / sqrt(a[i][i])
                     : 0;
    memset(w, 0, sizeof w);
    for (i = 0; i < 12; i++) { /* Cholesky of the block with a diagonal of 1 */
        for (j = 0; j <= i; j++) {
            double sum = i == j ? 1 + 1e-7 : a[i][j] * scale[i] * scale[j];
            for (k = 0; k < j; k++) sum -= a[i][k] * a[j][k]; /* rows before have the factor in place of the block */
            a[i][j] = i > j ? sum * a[j][j] : 1 / sqrt(sum > 1e-7 ? sum : 1e-7);
        }
    }
    for (j = 0; j < 12; j++) /* inverse of the factor, whose diagonal is inverted already */
        for (i = j; i < 12; i++) {
            double sum = i == j ? 1 : 0;
            for (k = j; k < i; k++) sum -= a[i][k] * w[k][j];
            w[i][j] = sum * a[i][i];
        }
    for (i = 0; i < 12; i++)
        for (j = 0; j <= i; j++) affine->root[group][i * (i + 1) / 2 + j] = (float)(w[i][j] * scale[j]);
}

/* Adds what followers have in chunks to the blocks of their masters that are in none. */
static void gxsp_affine_follower_slots(gxsp_system *system) {
    static const int full[9] = {0, 1, 2, 1, 3, 4, 2, 4, 5};
    const float *slots = (const float *)(const void *)system->vectors.slots;
    uint32_t i, s, n;
    int k;
    for (i = 0; i < system->model.follower_count; i++) {
        const gxsp_follower *follower = &system->model.followers[i];
        for (s = system->mesh.copy_start[follower->copy]; s < system->mesh.copy_start[follower->copy + 1]; s++)
            for (n = 0; n < 4; n++) {
                const uint32_t master = follower->master[n];
                const double square = follower->weight[n] * follower->weight[n];
                double block[9];
                if (system->mesh.copy_start[master] < system->mesh.copy_start[master + 1] || !(square > 0)) continue;
                for (k = 0; k < 9; k++)
                    block[k] = square * (double)slots[6 * (size_t)system->mesh.copy_slot[s] + (size_t)full[k]];
                gxsp_add_own(&system->affine, master, master, block);
            }
    }
}

/* Diagonal blocks from the tangents. rate: times scale */
static void gxsp_affine_diagonal(gxsp_system *system, double rate) {
    static const int packed[6] = {0, 1, 2, 4, 5, 8};
    gxsp_affine *affine = &system->affine;
    uint32_t b, group;
    size_t t;
    int l, k, p;
    memset(affine->own, 0, system->model.n * sizeof *affine->own);
    memset(affine->full, 0, affine->group_count * sizeof *affine->full);
    for (b = 0; b < affine->block_count; b++)
        for (l = 0; l < GXSP_LANES && !affine->blocks[b].still; l++)
            if (affine->blocks[b].vector[0][l] != GXSP_NONE)
                gxsp_affine_element_blocks(system, &affine->blocks[b], l, rate);
    gxsp_affine_follower_slots(system);
    for (t = 0; t < system->lasting->count; t++) gxsp_affine_term(system, &system->lasting->term[t]);
    for (group = 0; group < affine->group_count; group++) {
        for (p = 0; p < 4; p++)
            for (k = 0; k < 6; k++)
                affine->own[affine->member[group][p]][k] = gxsp_follows(system, affine->member[group][p])
                                                             ? 0
                                                             : affine->full[group][gxsp_packed_mass[p][p]][packed[k]];
        gxsp_affine_invert(system, group);
    }
}

/* z = D^-1 x of a group's twelve numbers */
static void gxsp_affine_apply(const gxsp_affine *affine, uint32_t group, const double x[12], double z[12]) {
    const float *root = affine->root[group];
    double y[12];
    int i, j;
    for (i = 0; i < 12; i++)
        for (j = 0, y[i] = 0; j <= i; j++) y[i] += (double)root[i * (i + 1) / 2 + j] * x[j];
    for (j = 0; j < 12; j++)
        for (i = j, z[j] = 0; i < 12; i++) z[j] += (double)root[i * (i + 1) / 2 + j] * y[i];
}

/* >>forces: energies and forces of chunks -------------------------------------------------------------------------- */

/* In: displacements. Out: energies of components; elastic and inertial forces of copies. A task writes the slots
 * and partial sums of its own chunk only. */

/* Prefetches the block that a pass reads `ahead` blocks later, in this chunk or the next: its tangents, or the data
 * that they are made from. */
GXSP_INLINE void gxsp_prefetch_block(const gxsp_system *system, size_t index, uint32_t block, uint32_t ahead,
                                     int tangents) {
    const gxsp_chunk *chunk = &system->mesh.chunks[index];
    uint32_t b = block + ahead;
    if (b >= chunk->block_count) {
        b -= chunk->block_count;
        if (index + 1 == system->mesh.chunk_count || b >= chunk[1].block_count) return;
        chunk++;
    }
    gxsp_prefetch(&chunk->corners[b], sizeof *chunk->corners);
    if (tangents)
        gxsp_prefetch(&chunk->tangents[b], sizeof *chunk->tangents);
    else
        gxsp_prefetch(&chunk->rest[b], sizeof *chunk->rest);
    if (chunk->moments) gxsp_prefetch(&chunk->moments[b], sizeof *chunk->moments);
}

/* Numbers of a chunk's nodes: x 3, and one more, which vectors read */
typedef double gxsp_near[GXSP_NEAR_NUMBERS];

/* x of a chunk's nodes. Returns to; NULL: there is no room for so many nodes */
static const double *gxsp_chunk_load(const gxsp_system *system, const gxsp_chunk *chunk, const double *x,
                                     double *GXSP_RESTRICT to) {
    const uint32_t *copies = system->mesh.nodes + chunk->first_node;
    size_t i, c;
    if (chunk->node_count > GXSP_NEAR) return NULL;
    for (i = 0; i < chunk->node_count; i++) {
        gxsp_prefetch(x + 3 * (size_t)copies[i + GXSP_AHEAD], 3 * sizeof *x);
        for (c = 0; c < 3; c++) to[3 * i + c] = x[3 * (size_t)copies[i] + c];
    }
    to[3 * i] = 0;
    return to;
}

#if defined(GXSP_SHUFFLES) && !defined(GXSP_AVX)
/* Three numbers of each of two nodes to three arrays */
static inline void gxsp_load_two(const double *x, const double *y, double *to0, double *to1, double *to2) {
    const gxsp_pair a = GXSP_LOAD_PAIR(x), b = GXSP_LOAD_PAIR(y);
    GXSP_STORE_PAIR(to0, GXSP_EVENS(a, b));
    GXSP_STORE_PAIR(to1, GXSP_ODDS(a, b));
    to2[0] = x[2], to2[1] = y[2];
}
#endif

/* Three numbers of each of four nodes to three arrays. The last node's are followed by one more. */
static inline void gxsp_load_four(const uint16_t *node, const double *x, double *to0, double *to1, double *to2) {
#if defined(GXSP_AVX)
    const gxsp_doubles a = *(const gxsp_doubles *)(x + 3 * (size_t)node[0]),
                       b = *(const gxsp_doubles *)(x + 3 * (size_t)node[1]),
                       c = *(const gxsp_doubles *)(x + 3 * (size_t)node[2]),
                       d = *(const gxsp_doubles *)(x + 3 * (size_t)node[3]);
    const gxsp_doubles p = __builtin_shufflevector(a, b, 0, 4, 2, 6), q = __builtin_shufflevector(c, d, 0, 4, 2, 6);
    const gxsp_doubles r = __builtin_shufflevector(a, b, 1, 5, 3, 7), s = __builtin_shufflevector(c, d, 1, 5, 3, 7);
    *(gxsp_doubles *)to0 = __builtin_shufflevector(p, q, 0, 1, 4, 5);
    *(gxsp_doubles *)to1 = __builtin_shufflevector(r, s, 0, 1, 4, 5);
    *(gxsp_doubles *)to2 = __builtin_shufflevector(p, q, 2, 3, 6, 7);
#elif defined(GXSP_SHUFFLES)
    gxsp_load_two(x + 3 * (size_t)node[0], x + 3 * (size_t)node[1], to0, to1, to2);
    gxsp_load_two(x + 3 * (size_t)node[2], x + 3 * (size_t)node[3], to0 + 2, to1 + 2, to2 + 2);
#else
    int l;
    for (l = 0; l < 4; l++)
        to0[l] = x[3 * (size_t)node[l]], to1[l] = x[3 * (size_t)node[l] + 1], to2[l] = x[3 * (size_t)node[l] + 2];
#endif
}

/* x of a block's corners from that of the chunk's nodes. A corner that has not changed since the block before keeps
 * its values. */
static void gxsp_block_load_near(const gxsp_chunk *chunk, uint32_t b, const double *GXSP_RESTRICT x,
                                 gxsp_lanes *GXSP_RESTRICT corners) {
    const gxsp_corners *corner = &chunk->corners[b];
    int i, l;
    for (i = 0; i < 4; i++)
        for (l = 0; l < GXSP_LANES && chunk->changed[b] >> i & 1; l += 4)
            gxsp_load_four(corner->node[i] + l, x, corners[3 * i] + l, corners[3 * i + 1] + l, corners[3 * i + 2] + l);
}

/* The same from x of all copies */
static void gxsp_block_load_copies(const gxsp_system *system, const gxsp_chunk *chunk, uint32_t b, const double *x,
                                   gxsp_lanes *corners) {
    const uint32_t *copies = system->mesh.nodes + chunk->first_node;
    int i, l;
    for (i = 0; i < 4; i++)
        for (l = 0; l < GXSP_LANES && chunk->changed[b] >> i & 1; l++) {
            const double *copy = x + 3 * (size_t)copies[chunk->corners[b].node[i][l]];
            corners[3 * i][l] = copy[0], corners[3 * i + 1][l] = copy[1], corners[3 * i + 2][l] = copy[2];
        }
}

/* The same from what gxsp_chunk_load has returned for x */
static inline void gxsp_block_load(const gxsp_system *system, const gxsp_chunk *chunk, uint32_t b, const double *near,
                                   const double *x, gxsp_lanes *corners) {
    if (near)
        gxsp_block_load_near(chunk, b, near, corners);
    else
        gxsp_block_load_copies(system, chunk, b, x, corners);
}

/* Shape function gradients of a block. rest: positions of the chunk's nodes (gxsp_chunk_load); corners: of the
 * block's, kept from block to block as in gxsp_block_load_near */
static gxsp_lanes *gxsp_block_gradients(const gxsp_system *system, const gxsp_chunk *chunk, uint32_t b,
                                        const double *rest, gxsp_lanes *corners, gxsp_lanes *made) {
    if (chunk->gradients) return chunk->gradients[b].entry;
    gxsp_block_load(system, chunk, b, rest, system->model.positions, corners);
    gxsp_gradients_make(chunk->rest[b].weight, corners, made);
    return made;
}

/* Adds forces of a block to the chunk's slots, 3 doubles each, and sets them to 0. Forces on a corner that the next
 * block has too are kept for it. */
static void gxsp_block_store(const gxsp_chunk *chunk, uint32_t b, gxsp_lanes *GXSP_RESTRICT values,
                             double *GXSP_RESTRICT slots) {
    const gxsp_corners *corner = &chunk->corners[b];
    int i, k, l;
    for (i = 0; i < 4; i++) {
        if (!(chunk->changed[b + 1] >> i & 1)) continue;
        for (l = 0; l < GXSP_LANES; l++) {
            double *to = slots + 3 * (size_t)corner->node[i][l];
            to[0] += values[3 * i][l];
            to[1] += values[3 * i + 1][l];
            to[2] += values[3 * i + 2][l];
        }
        for (k = 3 * i; k < 3 * i + 3; k++) GXSP_EACH_LANE(l) values[k][l] = 0;
    }
}

/* Is a copy of the chunk off its target? Hardly any is where Newton's method starts. */
static int gxsp_accelerates(const gxsp_system *system, const gxsp_chunk *chunk, const double *from) {
    const uint32_t *copies = system->mesh.nodes + chunk->first_node;
    uint32_t i;
    for (i = 0; i < chunk->node_count; i++)
        if (memcmp(from + 3 * (size_t)copies[i], system->vectors.target + 3 * (size_t)copies[i], 3 * sizeof(double)) !=
            0)
            return 1;
    return 0;
}

/* Have all components of a chunk found their lengths? */
static int gxsp_chunk_settled(const gxsp_system *system, const gxsp_chunk *chunk) {
    uint32_t i;
    for (i = 0; i < chunk->partial_count; i++)
        if (!system->model
                 .components[system->model.components[system->mesh.partials[chunk->first_partial + i].component].lead]
                 .settled)
            return 0;
    return 1;
}

/* The chunk's partial sum of a component */
static gxsp_partial *gxsp_find_partial(const gxsp_system *system, const gxsp_chunk *chunk, uint32_t component) {
    gxsp_partial *partials = system->mesh.partials + chunk->first_partial;
    uint32_t low = 0, high = chunk->partial_count - 1;
    while (low < high) {
        const uint32_t middle = low + (high - low) / 2;
        if (partials[middle].component < component)
            low = middle + 1;
        else
            high = middle;
    }
    return &partials[low];
}

/* Adds the energies of a block's elements to the partial sums of their components. */
static void gxsp_add_energies(const gxsp_system *system, const gxsp_chunk *chunk, uint32_t b, gxsp_lanes *energies) {
    const uint32_t *copies = system->mesh.nodes + chunk->first_node;
    int k, l;
    for (k = 0; k < 3 && chunk->partial_count == 1; k++) {
        double sum = 0;
        for (l = 0; l < GXSP_LANES; l++) sum += energies[k][l];
        system->mesh.partials[chunk->first_partial].energies[k] += sum;
    }
    for (l = 0; l < GXSP_LANES && chunk->partial_count > 1; l++) {
        gxsp_partial *partial =
            gxsp_find_partial(system, chunk, system->model.component[copies[chunk->corners[b].node[0][l]]]);
        for (k = 0; k < 3; k++) partial->energies[k] += energies[k][l];
    }
}

/* Energies and forces of a chunk's blocks, into its partial sums and slots, which are 0. positions, state: what
 * gxsp_chunk_load has returned for positions and pass->from */
static GXSP_APART void gxsp_blocks_state(const gxsp_pass *pass, size_t index, const double *positions,
                                         const double *state) {
    gxsp_system *system = pass->system;
    const gxsp_chunk *chunk = &system->mesh.chunks[index];
    double *slots = &system->vectors.slots[chunk->first_node][0];
    const int inertia = pass->inertia && gxsp_accelerates(system, chunk, pass->from);
    uint32_t b;
    int k, l;
    gxsp_lanes corners[12], x[12], other[12], forces[12], made[9];
    memset(forces, 0, sizeof forces);
    for (b = 0; b < chunk->block_count; b++) {
        const gxsp_rest *rest = &chunk->rest[b];
        gxsp_lanes ahead[9], led[12], energies[3], *gradients;
        gxsp_state s;
        gxsp_prefetch_block(system, index, b, GXSP_RESTS_AHEAD, 0);
        gxsp_block_load(system, chunk, b, state, pass->from, x);
        gradients = gxsp_block_gradients(system, chunk, b, positions, corners, made);
        if (inertia || pass->rotated) /* never both: rotated stresses come without inertia */
            gxsp_block_load_copies(system, chunk, b, inertia ? system->vectors.target : pass->rotated, other);
        gxsp_block_parameters(pass->materials, rest, &s);
        gxsp_block_gradient(gradients, x, s.g);
        if (pass->rotated) gxsp_block_gradient(gradients, other, ahead);
        if (pass->nudge && chunk->kind != GXS_LINEAR && chunk->kind != GXS_CUSTOM) gxsp_nudge(s.g);
        gxsp_material_state(chunk->kind, &s);
        if (pass->rotated && chunk->kind != GXS_LINEAR) gxsp_rotate_stress(s.g, ahead, s.p);
        gxsp_block_force(rest->weight, gradients, s.p, forces);
        for (l = 0; l < GXSP_LANES; l++) {
            energies[0][l] = rest->weight[l] * s.energy[l];
            energies[1][l] = 0;
            energies[2][l] = rest->weight[l] * s.size[l];
        }
        if (inertia) {
            for (k = 0; k < 12; k++) GXSP_EACH_LANE(l) led[k][l] = x[k][l] - other[k][l];
            gxsp_block_inertia(rest, gxsp_block_moments(chunk, b), pass->rate, led, forces, energies[1]);
            for (l = 0; l < GXSP_LANES; l++) energies[2][l] += energies[1][l];
        }
        gxsp_add_energies(system, chunk, b, energies);
        gxsp_block_store(chunk, b, forces, slots);
    }
}

/* Energies of a chunk at pass->from, component by component, and elastic + inertial forces */
static void gxsp_task_state(void *context, size_t index) {
    const gxsp_pass *pass = (const gxsp_pass *)context;
    gxsp_system *system = pass->system;
    const gxsp_chunk *chunk = &system->mesh.chunks[index];
    const double *rest = NULL;
    gxsp_near positions, state;
    uint32_t p;
    if (gxsp_chunk_settled(system, chunk)) return;
    for (p = 0; p < chunk->partial_count; p++)
        memset(system->mesh.partials[chunk->first_partial + p].energies, 0, sizeof system->mesh.partials->energies);
    memset(system->vectors.slots[chunk->first_node], 0, chunk->node_count * sizeof *system->vectors.slots);
    if (system->state.chunk_still[index]) return;
    if (!chunk->gradients) rest = gxsp_chunk_load(system, chunk, system->model.positions, positions);
    gxsp_blocks_state(pass, index, rest, gxsp_chunk_load(system, chunk, pass->from, state));
}

/* sum = sum over the slots of each copy, 3 doubles each */
static void gxsp_task_sum(void *context, size_t index) {
    const gxsp_pass *pass = (const gxsp_pass *)context;
    const gxsp_system *system = pass->system;
    const double *slots = &system->vectors.slots[0][0];
    size_t i, end = gxsp_range(system, index, &i);
    for (; i < end; i++) {
        double x = 0, y = 0, z = 0;
        uint32_t s;
        for (s = system->mesh.copy_start[i]; s < system->mesh.copy_start[i + 1]; s++) {
            const double *from = slots + 3 * (size_t)system->mesh.copy_slot[s];
            gxsp_prefetch(slots + 3 * (size_t)system->mesh.copy_slot[s + GXSP_AHEAD], 3 * sizeof *slots);
            x += from[0], y += from[1], z += from[2];
        }
        pass->sum[3 * i] = x, pass->sum[3 * i + 1] = y, pass->sum[3 * i + 2] = z;
    }
}

/* Energies of the components' elements at from, and elastic + inertial forces, 0 where a component sleeps. rotated:
 * see gxsp_pass */
static void gxsp_evaluate_elements(gxsp_system *system, double rate, const double *from, const double *rotated,
                                   int nudge, double *force) {
    gxsp_pass pass;
    uint32_t p;
    int k;
    memset(&pass, 0, sizeof pass);
    pass.system = system;
    pass.materials = system->state.damped;
    pass.rate = rate;
    pass.from = from;
    pass.sum = force;
    pass.inertia = rate > 0 && !system->model.lumped_mass;
    pass.rotated = rotated;
    pass.nudge = nudge;
    gxsp_parallel(system->jobs, system->mesh.chunk_count, gxsp_task_state, &pass);
    gxsp_over_ranges(system, gxsp_task_sum, &pass, NULL, 0);
    for (p = 0; p < system->model.component_count; p++)
        memset(system->model.components[p].energies, 0, sizeof system->model.components->energies);
    for (p = 0; p < system->mesh.partial_count; p++)
        for (k = 0; k < 3; k++)
            system->model.components[system->model.components[system->mesh.partials[p].component].lead].energies[k] +=
                system->mesh.partials[p].energies[k];
    if (system->affine.count > 0) gxsp_affine_evaluate(system, &pass);
    if (rate > 0 && system->model.lumped_mass) {
        size_t i;
        for (i = 0; i < 3 * system->model.n; i++)
            if (!system->state.still[i / 3]) {
                double moved = from[i] - system->vectors.target[i],
                       inertia = rate * system->model.lumped[i / 3] * moved;
                double *energies = gxsp_lead_of(system, i / 3)->energies;
                force[i] += inertia;
                energies[1] += 0.5 * inertia * moved;
                energies[2] += 0.5 * inertia * moved;
            }
    }
}

/* >>blocks: vectors of copies and 3x3 blocks, nine numbers by columns ---------------------------------------------- */

/* In and out: a few numbers at a time. Vector code stands beside plain C that computes the same. */

/* Stores whole vectors: processors cannot forward narrower stores to the wide loads that soon follow. */
static inline void gxsp_transpose_block(const float *GXSP_RESTRICT a, float *GXSP_RESTRICT transposed) {
#if defined(GXSP_AVX)
    const gxsp_eight all = *(const gxsp_eight *)a;
    *(gxsp_eight *)transposed = __builtin_shufflevector(all, all, 0, 3, 6, 1, 4, 7, 2, 5);
#elif defined(GXSP_SHUFFLES)
    const gxsp_four low = GXSP_LOAD(a), high = GXSP_LOAD(a + 4);
    const gxsp_four p = GXSP_HALVES(high, low, 2, 2, 1, 1), q = GXSP_HALVES(low, high, 2, 2, 1, 1);
    GXSP_STORE(transposed, GXSP_HALVES(low, p, 0, 3, 0, 2));
    GXSP_STORE(transposed + 4, GXSP_HALVES(high, q, 0, 3, 0, 2));
#else
    transposed[0] = a[0], transposed[1] = a[3], transposed[2] = a[6], transposed[3] = a[1];
    transposed[4] = a[4], transposed[5] = a[7], transposed[6] = a[2], transposed[7] = a[5];
#endif
    transposed[8] = a[8];
}

/* to += lane l of nine numbers by rows, transposed or not, and mass on the diagonal */
static void gxsp_add_lane(gxsp_singles *GXSP_RESTRICT block, int l, int transposed, float mass,
                          float *GXSP_RESTRICT to) {
    const int r = transposed ? 3 : 1, c = transposed ? 1 : 3;
    to[0] += block[0][l] + mass, to[c] += block[1][l], to[2 * c] += block[2][l];
    to[r] += block[3][l], to[4] += block[4][l] + mass, to[r + 2 * c] += block[5][l];
    to[2 * r] += block[6][l], to[2 * r + c] += block[7][l], to[8] += block[8][l] + mass;
}

/* y += a x for nine numbers */
static void gxsp_add_scaled(float a, const float *GXSP_RESTRICT x, float *GXSP_RESTRICT y) {
    int k;
    for (k = 0; k < 8; k++) y[k] += a * x[k];
    y[8] += a * x[8];
}

/* y += a x for four numbers */
static inline void gxsp_add_four(float a, const float *GXSP_RESTRICT x, float *GXSP_RESTRICT y) {
#if defined(GXSP_SHUFFLES)
    GXSP_FILLED(all, a);
    GXSP_STORE(y, GXSP_PLUS(GXSP_LOAD(y), GXSP_TIMES(all, GXSP_LOAD(x))));
#else
    int k;
    for (k = 0; k < 4; k++) y[k] += a * x[k];
#endif
}

static void gxsp_add_mass(float mass, float *to) { to[0] += mass, to[4] += mass, to[8] += mass; }

/* y -= a x. The fourth number of y has no meaning, nor has the one behind a. */
static void gxsp_subtract_block(const float *GXSP_RESTRICT a, const float *GXSP_RESTRICT x, float *GXSP_RESTRICT y) {
    int k;
    for (k = 0; k < 4; k++) y[k] -= a[k] * x[0] + a[3 + k] * x[1] + a[6 + k] * x[2];
}

/* y -= a^T x */
static void gxsp_subtract_transposed(const float *GXSP_RESTRICT a, const float *GXSP_RESTRICT x,
                                     float *GXSP_RESTRICT y) {
    y[0] -= a[0] * x[0] + a[1] * x[1] + a[2] * x[2];
    y[1] -= a[3] * x[0] + a[4] * x[1] + a[5] * x[2];
    y[2] -= a[6] * x[0] + a[7] * x[1] + a[8] * x[2];
}

/* y = D^-1 x for packed D^-1 */
static void gxsp_apply_packed(const float *d, const float *x, float *y) {
    const float a = x[0], b = x[1], c = x[2];
    y[0] = d[0] * a + d[1] * b + d[2] * c;
    y[1] = d[1] * a + d[3] * b + d[4] * c;
    y[2] = d[2] * a + d[4] * b + d[5] * c;
}

#if defined(GXSP_SHUFFLES)
/* Four nodes' vectors to three components side by side and back */
#if defined(GXSP_AVX)
/* All eight lanes at once: narrower stores would not be forwarded to the loads that soon follow. */
static inline void gxsp_gather_eight(const uint16_t *node, const gxsp_vector4 *x, float *to0, float *to1, float *to2) {
    const gxsp_four a = *(const gxsp_four *)x[node[0]], b = *(const gxsp_four *)x[node[1]],
                    c = *(const gxsp_four *)x[node[2]], d = *(const gxsp_four *)x[node[3]],
                    e = *(const gxsp_four *)x[node[4]], f = *(const gxsp_four *)x[node[5]],
                    g = *(const gxsp_four *)x[node[6]], h = *(const gxsp_four *)x[node[7]];
    const gxsp_eight ae = __builtin_shufflevector(a, e, 0, 1, 2, 3, 4, 5, 6, 7),
                     bf = __builtin_shufflevector(b, f, 0, 1, 2, 3, 4, 5, 6, 7),
                     cg = __builtin_shufflevector(c, g, 0, 1, 2, 3, 4, 5, 6, 7),
                     dh = __builtin_shufflevector(d, h, 0, 1, 2, 3, 4, 5, 6, 7);
    const gxsp_eight p = __builtin_shufflevector(ae, bf, 0, 8, 1, 9, 4, 12, 5, 13),
                     q = __builtin_shufflevector(cg, dh, 0, 8, 1, 9, 4, 12, 5, 13);
    const gxsp_eight r = __builtin_shufflevector(ae, bf, 2, 10, 3, 11, 6, 14, 7, 15),
                     s = __builtin_shufflevector(cg, dh, 2, 10, 3, 11, 6, 14, 7, 15);
    *(gxsp_eight *)to0 = __builtin_shufflevector(p, q, 0, 1, 8, 9, 4, 5, 12, 13);
    *(gxsp_eight *)to1 = __builtin_shufflevector(p, q, 2, 3, 10, 11, 6, 7, 14, 15);
    *(gxsp_eight *)to2 = __builtin_shufflevector(r, s, 0, 1, 8, 9, 4, 5, 12, 13);
}
#else
static inline void gxsp_gather_four(const uint16_t *node, const gxsp_vector4 *x, float *to0, float *to1, float *to2) {
    const gxsp_four a = GXSP_LOAD(x[node[0]]), b = GXSP_LOAD(x[node[1]]), c = GXSP_LOAD(x[node[2]]),
                    d = GXSP_LOAD(x[node[3]]);
    const gxsp_four p = GXSP_ZIP_LOW(a, b), q = GXSP_ZIP_LOW(c, d);
    const gxsp_four r = GXSP_ZIP_HIGH(a, b), s = GXSP_ZIP_HIGH(c, d);
    GXSP_STORE(to0, GXSP_JOIN_LOW(p, q));
    GXSP_STORE(to1, GXSP_JOIN_HIGH(p, q));
    GXSP_STORE(to2, GXSP_JOIN_LOW(r, s));
}

/* Compilers shuffle vectors longer than the machine's number by number. */
static inline void gxsp_gather_eight(const uint16_t *node, const gxsp_vector4 *x, float *to0, float *to1, float *to2) {
    gxsp_gather_four(node, x, to0, to1, to2);
    gxsp_gather_four(node + 4, x, to0 + 4, to1 + 4, to2 + 4);
}
#endif

static inline void gxsp_scatter_four(const uint16_t *node, const float *from0, const float *from1, const float *from2,
                                     gxsp_vector4 *y) {
    const gxsp_four p = GXSP_LOAD(from0), q = GXSP_LOAD(from1), r = GXSP_LOAD(from2);
    const gxsp_four low = GXSP_ZIP_LOW(p, q), high = GXSP_ZIP_HIGH(p, q);
    GXSP_STORE(y[node[0]], GXSP_PLUS(GXSP_LOAD(y[node[0]]), GXSP_HALVES(low, r, 0, 1, 0, 0)));
    GXSP_STORE(y[node[1]], GXSP_PLUS(GXSP_LOAD(y[node[1]]), GXSP_HALVES(low, r, 2, 3, 1, 1)));
    GXSP_STORE(y[node[2]], GXSP_PLUS(GXSP_LOAD(y[node[2]]), GXSP_HALVES(high, r, 0, 1, 2, 2)));
    GXSP_STORE(y[node[3]], GXSP_PLUS(GXSP_LOAD(y[node[3]]), GXSP_HALVES(high, r, 2, 3, 3, 3)));
}

static inline void gxsp_transpose_four(const float *a, const float *b, const float *c, const float *d,
                                       gxsp_four *transposed) {
    const gxsp_four p = GXSP_LOAD(a), q = GXSP_LOAD(b), r = GXSP_LOAD(c), s = GXSP_LOAD(d);
    const gxsp_four low = GXSP_ZIP_LOW(p, q), high = GXSP_ZIP_HIGH(p, q);
    const gxsp_four next = GXSP_ZIP_LOW(r, s), last = GXSP_ZIP_HIGH(r, s);
    transposed[0] = GXSP_JOIN_LOW(low, next);
    transposed[1] = GXSP_JOIN_HIGH(low, next);
    transposed[2] = GXSP_JOIN_LOW(high, last);
    transposed[3] = GXSP_JOIN_HIGH(high, last);
}

/* Six numbers of each of four lanes to those of their nodes, six side by side */
static inline void gxsp_scatter_six(const uint16_t *node, gxsp_singles *from, int lane, float *y) {
    const gxsp_four p = GXSP_LOAD(from[4] + lane), q = GXSP_LOAD(from[5] + lane);
    const gxsp_four low = GXSP_ZIP_LOW(p, q), high = GXSP_ZIP_HIGH(p, q);
    gxsp_four first[4];
    int k;
    gxsp_transpose_four(from[0] + lane, from[1] + lane, from[2] + lane, from[3] + lane, first);
    for (k = 0; k < 4; k++)
        GXSP_STORE(y + 6 * (size_t)node[k], GXSP_PLUS(GXSP_LOAD(y + 6 * (size_t)node[k]), first[k]));
    GXSP_ADD_LOW(y + 6 * (size_t)node[0] + 4, low);
    GXSP_ADD_HIGH(y + 6 * (size_t)node[1] + 4, low);
    GXSP_ADD_LOW(y + 6 * (size_t)node[2] + 4, high);
    GXSP_ADD_HIGH(y + 6 * (size_t)node[3] + 4, high);
}

/* Each lane's nine numbers to those of its entry */
static inline void gxsp_add_lanes(const uint16_t *entry, gxsp_singles *block, float (*to)[9]) {
    int l, k;
    for (l = 0; l < GXSP_LANES; l += 4) {
        gxsp_four first[4], second[4];
        gxsp_transpose_four(block[0] + l, block[1] + l, block[2] + l, block[3] + l, first);
        gxsp_transpose_four(block[4] + l, block[5] + l, block[6] + l, block[7] + l, second);
        for (k = 0; k < 4; k++) {
            float *sum = to[entry[l + k]];
            GXSP_STORE(sum, GXSP_PLUS(GXSP_LOAD(sum), first[k]));
            GXSP_STORE(sum + 4, GXSP_PLUS(GXSP_LOAD(sum + 4), second[k]));
            sum[8] += block[8][l + k];
        }
    }
}
#else
static void gxsp_gather_eight(const uint16_t *node, const gxsp_vector4 *x, float *to0, float *to1, float *to2) {
    int l;
    for (l = 0; l < GXSP_LANES; l++) to0[l] = x[node[l]][0], to1[l] = x[node[l]][1], to2[l] = x[node[l]][2];
}

static void gxsp_scatter_four(const uint16_t *node, const float *from0, const float *from1, const float *from2,
                              gxsp_vector4 *y) {
    int l;
    for (l = 0; l < 4; l++) y[node[l]][0] += from0[l], y[node[l]][1] += from1[l], y[node[l]][2] += from2[l];
}

static void gxsp_scatter_six(const uint16_t *node, gxsp_singles *from, int lane, float *y) {
    int k, l;
    for (l = 0; l < 4; l++)
        for (k = 0; k < 6; k++) y[6 * (size_t)node[l] + (size_t)k] += from[k][lane + l];
}

static void gxsp_add_lanes(const uint16_t *entry, gxsp_singles *block, float (*to)[9]) {
    int l, k;
    for (l = 0; l < GXSP_LANES; l++)
        for (k = 0; k < 9; k++) to[entry[l]][k] += block[k][l];
}
#endif

/* x of a block's corners. A corner that has not changed since the block before keeps its values. */
static void gxsp_block_gather(const gxsp_chunk *chunk, uint32_t b, const gxsp_vector4 *GXSP_RESTRICT x,
                              gxsp_singles *GXSP_RESTRICT to) {
    const gxsp_corners *corner = &chunk->corners[b];
    int i;
    for (i = 0; i < 4; i++)
        if (chunk->changed[b] >> i & 1) gxsp_gather_eight(corner->node[i], x, to[3 * i], to[3 * i + 1], to[3 * i + 2]);
}

/* Adds a block's result to its corners, and sets it to 0. The result at a corner that the next block has too is
 * kept for it. */
static void gxsp_block_scatter(const gxsp_chunk *chunk, uint32_t b, gxsp_singles *GXSP_RESTRICT from,
                               gxsp_vector4 *GXSP_RESTRICT y) {
    const gxsp_corners *corner = &chunk->corners[b];
    int i, k, l;
    for (i = 0; i < 4; i++) {
        if (!(chunk->changed[b + 1] >> i & 1)) continue;
        for (l = 0; l < GXSP_LANES; l += 4)
            gxsp_scatter_four(corner->node[i] + l, from[3 * i] + l, from[3 * i + 1] + l, from[3 * i + 2] + l, y);
        for (k = 3 * i; k < 3 * i + 3; k++) GXSP_EACH_LANE(l) from[k][l] = 0;
    }
}

/* As gxsp_block_gather, from x of all copies */
static GXSP_COLD void gxsp_block_gather_copies(const gxsp_system *system, const gxsp_chunk *chunk, uint32_t b,
                                               const gxsp_vector4 *x, gxsp_singles *to) {
    const uint32_t *copies = system->mesh.nodes + chunk->first_node;
    int i, l, c;
    for (i = 0; i < 4; i++)
        for (l = 0; l < GXSP_LANES && chunk->changed[b] >> i & 1; l++)
            for (c = 0; c < 3; c++) to[3 * i + c][l] = x[copies[chunk->corners[b].node[i][l]]][c];
}

/* >>strains: forces, Hessians and energies of stable neo-Hookean elements, in single precision --------------------- */

/* In: a displacement. Out: forces in the chunks' slots, the strains that products need, or energies of components.
 * >>leapfrog and >>quick use it. The Hessian is exact: nothing is decomposed or projected, so that a strain costs no
 * more than the forces there. It may be indefinite where elements are pressed. */

/* Forces of a block, dU/du, added to y; and the largest modulus of its Hessians relative to that at rest. With G the
 * gradient of the displacement x, F = 1 + G, P = mu (1 - 1 / (Ic + 1)) F + (lambda (J - 1) - 3/4 mu) cof F, written so
 * that nothing cancels near rest. The modulus is at most the sum of those of the terms of its derivative:
 *     mu Ic / (Ic + 1) + 2 mu Ic / (Ic + 1)^2 + lambda |cof F|^2 + |lambda (J - 1) - 3/4 mu| |F|,
 *     |F| <= (3 + Ic) / sqrt 12
 * strain, unless NULL, receives what products need, in place of the modulus; scale: of the operator
 */
GXSP_INLINE void gxsp_leap_force(const gxsp_leap_block *GXSP_RESTRICT b, gxsp_singles *GXSP_RESTRICT x,
                                 gxsp_singles *GXSP_RESTRICT y, float *GXSP_RESTRICT stiffest, int keep, float scale,
                                 gxsp_strain *GXSP_RESTRICT strain) {
    int l;
    GXSP_EACH_LANE(l) {
        const float g0 = b->gradient[0][l], g1 = b->gradient[1][l], g2 = b->gradient[2][l], g3 = b->gradient[3][l],
                    g4 = b->gradient[4][l], g5 = b->gradient[5][l], g6 = b->gradient[6][l], g7 = b->gradient[7][l],
                    g8 = b->gradient[8][l], mu = b->mu[l], lambda = b->lambda[l];
        const float x0 = x[0][l], x1 = x[1][l], x2 = x[2][l];
        const float p0 = x[3][l] - x0, p1 = x[4][l] - x1, p2 = x[5][l] - x2, q0 = x[6][l] - x0, q1 = x[7][l] - x1,
                    q2 = x[8][l] - x2, r0 = x[9][l] - x0, r1 = x[10][l] - x1, r2 = x[11][l] - x2;
        const float d0 = p0 * g0 + q0 * g3 + r0 * g6, d1 = p0 * g1 + q0 * g4 + r0 * g7,
                    d2 = p0 * g2 + q0 * g5 + r0 * g8, d3 = p1 * g0 + q1 * g3 + r1 * g6,
                    d4 = p1 * g1 + q1 * g4 + r1 * g7, d5 = p1 * g2 + q1 * g5 + r1 * g8,
                    d6 = p2 * g0 + q2 * g3 + r2 * g6, d7 = p2 * g1 + q2 * g4 + r2 * g7,
                    d8 = p2 * g2 + q2 * g5 + r2 * g8;
        /* cofactors of G; those of F less 1 */
        const float k0 = d4 * d8 - d5 * d7, k1 = d5 * d6 - d3 * d8, k2 = d3 * d7 - d4 * d6, k3 = d2 * d7 - d1 * d8,
                    k4 = d0 * d8 - d2 * d6, k5 = d1 * d6 - d0 * d7, k6 = d1 * d5 - d2 * d4, k7 = d2 * d3 - d0 * d5,
                    k8 = d0 * d4 - d1 * d3;
        const float trace = d0 + d4 + d8;
        const float c0 = trace - d0 + k0, c1 = k1 - d3, c2 = k2 - d6, c3 = k3 - d1, c4 = trace - d4 + k4, c5 = k5 - d7,
                    c6 = k6 - d2, c7 = k7 - d5, c8 = trace - d8 + k8;
        const float square = d0 * d0 + d1 * d1 + d2 * d2 + d3 * d3 + d4 * d4 + d5 * d5 + d6 * d6 + d7 * d7 + d8 * d8;
        const float i = 2 * trace + square, j = trace + (k0 + k4 + k8) + (d0 * k0 + d1 * k1 + d2 * k2); /* Ic-3, J-1 */
        const float inverse = 1 / (i + 4), growth = 0.25f * mu * i * inverse, rest = 0.75f * mu;
        const float pressure = lambda * j, own = rest + growth, cofactor = pressure - rest, unit = growth + pressure;
        const float s0 = own * d0 + cofactor * c0 + unit, s1 = own * d1 + cofactor * c1, s2 = own * d2 + cofactor * c2,
                    s3 = own * d3 + cofactor * c3, s4 = own * d4 + cofactor * c4 + unit, s5 = own * d5 + cofactor * c5,
                    s6 = own * d6 + cofactor * c6, s7 = own * d7 + cofactor * c7, s8 = own * d8 + cofactor * c8 + unit;
        const float f0 = s0 * g0 + s1 * g1 + s2 * g2, f1 = s3 * g0 + s4 * g1 + s5 * g2,
                    f2 = s6 * g0 + s7 * g1 + s8 * g2, f3 = s0 * g3 + s1 * g4 + s2 * g5,
                    f4 = s3 * g3 + s4 * g4 + s5 * g5, f5 = s6 * g3 + s7 * g4 + s8 * g5,
                    f6 = s0 * g6 + s1 * g7 + s2 * g8, f7 = s3 * g6 + s4 * g7 + s5 * g8,
                    f8 = s6 * g6 + s7 * g7 + s8 * g8;
        if (keep) {
            const float times = scale * mu, push = scale * lambda;
            strain->gradient[0][l] = d0, strain->gradient[1][l] = d1, strain->gradient[2][l] = d2;
            strain->gradient[3][l] = d3, strain->gradient[4][l] = d4, strain->gradient[5][l] = d5;
            strain->gradient[6][l] = d6, strain->gradient[7][l] = d7, strain->gradient[8][l] = d8;
            strain->own[l] = times * (3 + i) * inverse;
            strain->along[l] = 2 * times * inverse * inverse;
            strain->sides[l] = push;
            strain->turn[l] = push * j - 0.75f * times;
        }
        if (!keep) {
            const float sides = (1 + c0) * (1 + c0) + (1 + c4) * (1 + c4) + (1 + c8) * (1 + c8) + c1 * c1 + c2 * c2 +
                                c3 * c3 + c5 * c5 + c6 * c6 + c7 * c7;
            const float steep = (cofactor > 0 ? cofactor : -cofactor) * (6 + i) * 0.2886752f;
            const float modulus = own + 2 * mu * (3 + i) * inverse * inverse + lambda * sides + steep;
            const float ratio = modulus / (2.4240382f * mu + 3 * lambda + 1e-30f);
            stiffest[l] = ratio > stiffest[l] ? ratio : stiffest[l];
        }
        y[0][l] -= f0 + f3 + f6, y[1][l] -= f1 + f4 + f7, y[2][l] -= f2 + f5 + f8;
        y[3][l] += f0, y[4][l] += f1, y[5][l] += f2, y[6][l] += f3, y[7][l] += f4, y[8][l] += f5, y[9][l] += f6,
            y[10][l] += f7, y[11][l] += f8;
    }
}

/* x of a copy relative to an origin, in single precision */
static inline void gxsp_leap_place(const double *x, const double *origin, float *to) {
    to[0] = (float)(x[0] - origin[0]), to[1] = (float)(x[1] - origin[1]), to[2] = (float)(x[2] - origin[2]);
}

/* pass->from of a chunk's nodes relative to its first one, before they are rounded: bodies may be far from where they
 * were at rest. Returns to; NULL: there is no room for so many nodes */
static const gxsp_vector4 *gxsp_leap_load(const gxsp_pass *pass, const gxsp_chunk *chunk, gxsp_vector4 *to) {
    const uint32_t *copies = pass->system->mesh.nodes + chunk->first_node;
    const double *origin = pass->from + 3 * (size_t)copies[0];
    uint32_t i;
    if (chunk->node_count > GXSP_NEAR) return NULL;
    for (i = 0; i < chunk->node_count; i++) {
        gxsp_prefetch(pass->from + 3 * (size_t)copies[i + GXSP_AHEAD], 3 * sizeof *pass->from);
        gxsp_leap_place(pass->from + 3 * (size_t)copies[i], origin, to[i]);
        to[i][3] = 0;
    }
    return (const gxsp_vector4 *)to;
}

/* As gxsp_block_gather, from pass->from of all copies relative to that of the chunk's first node */
static GXSP_COLD void gxsp_leap_gather_copies(const gxsp_pass *pass, const gxsp_chunk *chunk, uint32_t b,
                                              gxsp_singles *to) {
    const uint32_t *copies = pass->system->mesh.nodes + chunk->first_node;
    int i, l, c;
    for (i = 0; i < 4; i++)
        for (l = 0; l < GXSP_LANES && chunk->changed[b] >> i & 1; l++) {
            float place[3];
            gxsp_leap_place(pass->from + 3 * (size_t)copies[chunk->corners[b].node[i][l]],
                            pass->from + 3 * (size_t)copies[0], place);
            for (c = 0; c < 3; c++) to[3 * i + c][l] = place[c];
        }
}

/* pass->from at a block's corners. near: what gxsp_leap_load has returned */
static inline void gxsp_leap_gather(const gxsp_pass *pass, const gxsp_chunk *chunk, uint32_t b,
                                    const gxsp_vector4 *near, gxsp_singles *to) {
    if (near)
        gxsp_block_gather(chunk, b, near, to);
    else
        gxsp_leap_gather_copies(pass, chunk, b, to);
}

/* Forces of a chunk at pass->from into its slots, and its largest modulus */
static void gxsp_task_leap_force(void *context, size_t index) {
    const gxsp_pass *pass = (const gxsp_pass *)context;
    const gxsp_system *system = pass->system;
    const gxsp_chunk *chunk = &system->mesh.chunks[index];
    const gxsp_leap_block *blocks = system->leap.blocks + system->leap.first_block[index];
    const gxsp_vector4 *near;
    gxsp_vector4 in[GXSP_NEAR], *out = (gxsp_vector4 *)(void *)system->vectors.slots + chunk->first_node;
    gxsp_singles from[12], to[12], stiffest;
    uint32_t b;
    int l;
    system->leap.stiffest[index] = 0;
    if (system->state.chunk_still[index]) return;
    near = gxsp_leap_load(pass, chunk, in);
    memset(out, 0, chunk->node_count * sizeof *out);
    memset(to, 0, sizeof to);
    memset(stiffest, 0, sizeof stiffest);
    for (b = 0; b < chunk->block_count; b++) {
        if (b + GXSP_TANGENTS_AHEAD < chunk->block_count)
            gxsp_prefetch(&blocks[b + GXSP_TANGENTS_AHEAD], sizeof *blocks);
        gxsp_leap_gather(pass, chunk, b, near, from);
        gxsp_leap_force(&blocks[b], from, to, stiffest, 0, 0, NULL);
        gxsp_block_scatter(chunk, b, to, out);
    }
    for (l = 0; l < GXSP_LANES; l++)
        if (stiffest[l] > system->leap.stiffest[index]) system->leap.stiffest[index] = stiffest[l];
}

/* The same, with the strains */
static void gxsp_task_strain_force(void *context, size_t index) {
    const gxsp_pass *pass = (const gxsp_pass *)context;
    const gxsp_system *system = pass->system;
    const gxsp_chunk *chunk = &system->mesh.chunks[index];
    const size_t first = system->leap.first_block[index];
    const float scale = (float)system->model.scale;
    const gxsp_vector4 *near;
    gxsp_vector4 in[GXSP_NEAR], *out = (gxsp_vector4 *)(void *)system->vectors.slots + chunk->first_node;
    gxsp_singles from[12], to[12];
    uint32_t b;
    if (system->state.chunk_still[index]) return;
    near = gxsp_leap_load(pass, chunk, in);
    memset(out, 0, chunk->node_count * sizeof *out);
    memset(to, 0, sizeof to);
    for (b = 0; b < chunk->block_count; b++) {
        if (b + GXSP_TANGENTS_AHEAD < chunk->block_count)
            gxsp_prefetch(&system->leap.blocks[first + b + GXSP_TANGENTS_AHEAD], sizeof *system->leap.blocks);
        gxsp_leap_gather(pass, chunk, b, near, from);
        gxsp_leap_force(&system->leap.blocks[first + b], from, to, NULL, 1, scale, &system->leap.strains[first + b]);
        gxsp_block_scatter(chunk, b, to, out);
    }
}

/* y += K x at a strain. With D the gradient of x and F = 1 + G,
 *     dP = own D + along (F : D) F + sides (cof F : D) cof F + turn dcof F,
 * where dcof F is bilinear in F and D. A rotation of what is at rest meets nothing: own D + turn D^T = 0 there. */
static void gxsp_strain_product(const gxsp_leap_block *GXSP_RESTRICT b, const gxsp_strain *GXSP_RESTRICT s,
                                gxsp_singles *GXSP_RESTRICT x, gxsp_singles *GXSP_RESTRICT y) {
    int l;
    GXSP_EACH_LANE(l) {
        const float g0 = b->gradient[0][l], g1 = b->gradient[1][l], g2 = b->gradient[2][l], g3 = b->gradient[3][l],
                    g4 = b->gradient[4][l], g5 = b->gradient[5][l], g6 = b->gradient[6][l], g7 = b->gradient[7][l],
                    g8 = b->gradient[8][l], own = s->own[l], turn = s->turn[l];
        const float f0 = 1 + s->gradient[0][l], f1 = s->gradient[1][l], f2 = s->gradient[2][l], f3 = s->gradient[3][l],
                    f4 = 1 + s->gradient[4][l], f5 = s->gradient[5][l], f6 = s->gradient[6][l], f7 = s->gradient[7][l],
                    f8 = 1 + s->gradient[8][l];
        const float x0 = x[0][l], x1 = x[1][l], x2 = x[2][l];
        const float p0 = x[3][l] - x0, p1 = x[4][l] - x1, p2 = x[5][l] - x2, q0 = x[6][l] - x0, q1 = x[7][l] - x1,
                    q2 = x[8][l] - x2, r0 = x[9][l] - x0, r1 = x[10][l] - x1, r2 = x[11][l] - x2;
        const float d0 = p0 * g0 + q0 * g3 + r0 * g6, d1 = p0 * g1 + q0 * g4 + r0 * g7,
                    d2 = p0 * g2 + q0 * g5 + r0 * g8, d3 = p1 * g0 + q1 * g3 + r1 * g6,
                    d4 = p1 * g1 + q1 * g4 + r1 * g7, d5 = p1 * g2 + q1 * g5 + r1 * g8,
                    d6 = p2 * g0 + q2 * g3 + r2 * g6, d7 = p2 * g1 + q2 * g4 + r2 * g7,
                    d8 = p2 * g2 + q2 * g5 + r2 * g8;
        const float c0 = f4 * f8 - f5 * f7, c1 = f5 * f6 - f3 * f8, c2 = f3 * f7 - f4 * f6, c3 = f2 * f7 - f1 * f8,
                    c4 = f0 * f8 - f2 * f6, c5 = f1 * f6 - f0 * f7, c6 = f1 * f5 - f2 * f4, c7 = f2 * f3 - f0 * f5,
                    c8 = f0 * f4 - f1 * f3;
        const float t0 = f4 * d8 + d4 * f8 - f5 * d7 - d5 * f7, t1 = f5 * d6 + d5 * f6 - f3 * d8 - d3 * f8,
                    t2 = f3 * d7 + d3 * f7 - f4 * d6 - d4 * f6, t3 = f2 * d7 + d2 * f7 - f1 * d8 - d1 * f8,
                    t4 = f0 * d8 + d0 * f8 - f2 * d6 - d2 * f6, t5 = f1 * d6 + d1 * f6 - f0 * d7 - d0 * f7,
                    t6 = f1 * d5 + d1 * f5 - f2 * d4 - d2 * f4, t7 = f2 * d3 + d2 * f3 - f0 * d5 - d0 * f5,
                    t8 = f0 * d4 + d0 * f4 - f1 * d3 - d1 * f3;
        const float m = s->along[l] *
                        (f0 * d0 + f1 * d1 + f2 * d2 + f3 * d3 + f4 * d4 + f5 * d5 + f6 * d6 + f7 * d7 + f8 * d8),
                    n = s->sides[l] *
                        (c0 * d0 + c1 * d1 + c2 * d2 + c3 * d3 + c4 * d4 + c5 * d5 + c6 * d6 + c7 * d7 + c8 * d8);
        const float s0 = own * d0 + m * f0 + n * c0 + turn * t0, s1 = own * d1 + m * f1 + n * c1 + turn * t1,
                    s2 = own * d2 + m * f2 + n * c2 + turn * t2, s3 = own * d3 + m * f3 + n * c3 + turn * t3,
                    s4 = own * d4 + m * f4 + n * c4 + turn * t4, s5 = own * d5 + m * f5 + n * c5 + turn * t5,
                    s6 = own * d6 + m * f6 + n * c6 + turn * t6, s7 = own * d7 + m * f7 + n * c7 + turn * t7,
                    s8 = own * d8 + m * f8 + n * c8 + turn * t8;
        const float w0 = s0 * g0 + s1 * g1 + s2 * g2, w1 = s3 * g0 + s4 * g1 + s5 * g2,
                    w2 = s6 * g0 + s7 * g1 + s8 * g2, w3 = s0 * g3 + s1 * g4 + s2 * g5,
                    w4 = s3 * g3 + s4 * g4 + s5 * g5, w5 = s6 * g3 + s7 * g4 + s8 * g5,
                    w6 = s0 * g6 + s1 * g7 + s2 * g8, w7 = s3 * g6 + s4 * g7 + s5 * g8,
                    w8 = s6 * g6 + s7 * g7 + s8 * g8;
        y[0][l] -= w0 + w3 + w6, y[1][l] -= w1 + w4 + w7, y[2][l] -= w2 + w5 + w8;
        y[3][l] += w0, y[4][l] += w1, y[5][l] += w2, y[6][l] += w3, y[7][l] += w4, y[8][l] += w5, y[9][l] += w6,
            y[10][l] += w7, y[11][l] += w8;
    }
}

/* K x of a chunk into its slots, as gxsp_task_product does it */
static void gxsp_task_strain_product(void *context, size_t index) {
    const gxsp_pass *pass = (const gxsp_pass *)context;
    const gxsp_system *system = pass->system;
    const gxsp_chunk *chunk = &system->mesh.chunks[index];
    const uint32_t *copies = system->mesh.nodes + chunk->first_node;
    const gxsp_leap_block *blocks = system->leap.blocks + system->leap.first_block[index];
    const gxsp_strain *strains = system->leap.strains + system->leap.first_block[index];
    const int near = chunk->node_count <= GXSP_NEAR;
    gxsp_vector4 in[GXSP_NEAR], *out = (gxsp_vector4 *)(void *)system->vectors.slots + chunk->first_node;
    gxsp_singles from[12], to[12];
    uint32_t b, i;
    if (system->state.chunk_still[index]) return;
    for (i = 0; i < chunk->node_count && near; i++) {
        gxsp_prefetch(pass->x[copies[i + GXSP_AHEAD]], sizeof *pass->x);
        memcpy(in[i], pass->x[copies[i]], sizeof *in);
    }
    memset(out, 0, chunk->node_count * sizeof *out);
    memset(to, 0, sizeof to);
    for (b = 0; b < chunk->block_count; b++) {
        if (b + GXSP_TANGENTS_AHEAD < chunk->block_count) {
            gxsp_prefetch(blocks[b + GXSP_TANGENTS_AHEAD].gradient, sizeof blocks->gradient);
            gxsp_prefetch(&strains[b + GXSP_TANGENTS_AHEAD], sizeof *strains);
        }
        if (near)
            gxsp_block_gather(chunk, b, (const gxsp_vector4 *)in, from);
        else
            gxsp_block_gather_copies(system, chunk, b, (const gxsp_vector4 *)pass->x, from);
        gxsp_strain_product(&blocks[b], &strains[b], from, to);
        gxsp_block_scatter(chunk, b, to, out);
    }
}

/* Elastic energies of a block's elements, J; see gxsp_neo_hookean */
static void gxsp_strain_energy(const gxsp_leap_block *GXSP_RESTRICT b, gxsp_singles *GXSP_RESTRICT x,
                               double *GXSP_RESTRICT energy) {
    int l;
    GXSP_EACH_LANE(l) {
        const float g0 = b->gradient[0][l], g1 = b->gradient[1][l], g2 = b->gradient[2][l], g3 = b->gradient[3][l],
                    g4 = b->gradient[4][l], g5 = b->gradient[5][l], g6 = b->gradient[6][l], g7 = b->gradient[7][l],
                    g8 = b->gradient[8][l], mu = b->mu[l], lambda = b->lambda[l];
        const float x0 = x[0][l], x1 = x[1][l], x2 = x[2][l];
        const float p0 = x[3][l] - x0, p1 = x[4][l] - x1, p2 = x[5][l] - x2, q0 = x[6][l] - x0, q1 = x[7][l] - x1,
                    q2 = x[8][l] - x2, r0 = x[9][l] - x0, r1 = x[10][l] - x1, r2 = x[11][l] - x2;
        const float d0 = p0 * g0 + q0 * g3 + r0 * g6, d1 = p0 * g1 + q0 * g4 + r0 * g7,
                    d2 = p0 * g2 + q0 * g5 + r0 * g8, d3 = p1 * g0 + q1 * g3 + r1 * g6,
                    d4 = p1 * g1 + q1 * g4 + r1 * g7, d5 = p1 * g2 + q1 * g5 + r1 * g8,
                    d6 = p2 * g0 + q2 * g3 + r2 * g6, d7 = p2 * g1 + q2 * g4 + r2 * g7,
                    d8 = p2 * g2 + q2 * g5 + r2 * g8;
        const float k0 = d4 * d8 - d5 * d7, k1 = d5 * d6 - d3 * d8, k2 = d3 * d7 - d4 * d6, k4 = d0 * d8 - d2 * d6,
                    k8 = d0 * d4 - d1 * d3, trace = d0 + d4 + d8;
        const float square = d0 * d0 + d1 * d1 + d2 * d2 + d3 * d3 + d4 * d4 + d5 * d5 + d6 * d6 + d7 * d7 + d8 * d8;
        const float det = d0 * k0 + d1 * k1 + d2 * k2, i = 2 * trace + square, j = trace + (k0 + k4 + k8) + det;
        const float turned = d0 * d0 + d4 * d4 + d8 * d8 + 2 * (d1 * d3 + d2 * d6 + d5 * d7);
        energy[l] = (double)(0.375f * mu * (square + turned - trace * trace - 2 * det) + 0.5f * lambda * j * j) +
                    0.5 * (double)mu * gxsp_log_rest(0.25 * (double)i);
    }
}

/* Elastic energies of a chunk at pass->from, component by component */
static void gxsp_task_strain_energy(void *context, size_t index) {
    const gxsp_pass *pass = (const gxsp_pass *)context;
    const gxsp_system *system = pass->system;
    const gxsp_chunk *chunk = &system->mesh.chunks[index];
    const gxsp_leap_block *blocks = system->leap.blocks + system->leap.first_block[index];
    const gxsp_vector4 *near;
    gxsp_vector4 in[GXSP_NEAR];
    gxsp_lanes energies[3];
    gxsp_singles from[12];
    uint32_t b;
    memset(energies, 0, sizeof energies);
    for (b = 0; b < chunk->partial_count; b++)
        memset(system->mesh.partials[chunk->first_partial + b].energies, 0, sizeof system->mesh.partials->energies);
    if (system->state.chunk_still[index]) return;
    near = gxsp_leap_load(pass, chunk, in);
    for (b = 0; b < chunk->block_count; b++) {
        if (b + GXSP_TANGENTS_AHEAD < chunk->block_count)
            gxsp_prefetch(&blocks[b + GXSP_TANGENTS_AHEAD], sizeof *blocks);
        gxsp_leap_gather(pass, chunk, b, near, from);
        gxsp_strain_energy(&blocks[b], from, energies[0]);
        gxsp_add_energies(system, chunk, b, energies);
    }
}

/* >>singles: products of elements with affine copies --------------------------------------------------------------- */

/* In: tangents, a vector. Out: their product as in >>rule, in single precision, for conjugate gradients. >>doubles has
 * the other one. A task writes the results of its blocks side by side, in the memory of gxsp_affine.slots. */

/* For products in single precision: 4 N_i at each point, and (X_j - X_i) / (4 length) of the edges */
static void gxsp_affine_round(const gxsp_affine_block *block, gxsp_singles *GXSP_RESTRICT shape,
                              gxsp_singles *GXSP_RESTRICT way) {
    int p, k, l;
    for (p = 0; p < 4; p++)
        for (k = 0; k < 4; k++) GXSP_EACH_LANE(l) shape[4 * p + k][l] = (float)(4 * block->shape[p][k][l]);
    for (k = 0; k < 9; k++) GXSP_EACH_LANE(l) way[k][l] = (float)block->edge[k][l];
    for (k = 0; k < 6; k++) GXSP_EACH_LANE(l) way[9 + k][l] = (float)(block->edge[3 + k][l] - block->edge[k % 3][l]);
    for (k = 0; k < 3; k++) GXSP_EACH_LANE(l) way[15 + k][l] = (float)(block->edge[6 + k][l] - block->edge[3 + k][l]);
}

/* The edges at a corner, and the corners at their other ends */
static const uint8_t gxsp_corner_edges[4][3] = {{0, 1, 2}, {0, 3, 4}, {1, 3, 5}, {2, 4, 5}};
static const uint8_t gxsp_corner_others[4][3] = {{1, 2, 3}, {0, 2, 3}, {0, 1, 3}, {0, 1, 2}};

/* x of the vectors, with copies of the corners relative to corner 0, which goes to start */
static void gxsp_singles_gather(const gxsp_affine_block *block, const gxsp_vector4 *x, gxsp_singles *GXSP_RESTRICT to,
                                gxsp_singles *GXSP_RESTRICT start) {
    static const uint16_t lanes[GXSP_LANES] = {0, 1, 2, 3, 4, 5, 6, 7};
    static const gxsp_vector4 none = {0, 0, 0, 0};
    gxsp_vector4 in[GXSP_LANES];
    int k, l;
    for (k = 0; k < 16; k++) {
        for (l = 0; l < GXSP_LANES; l++)
            memcpy(in[l], block->vector[k][l] == GXSP_NONE ? none : x[block->vector[k][l]], sizeof *in);
        gxsp_gather_eight(lanes, (const gxsp_vector4 *)in, to[3 * k], to[3 * k + 1], to[3 * k + 2]);
    }
    memcpy(start, to, 3 * sizeof *to);
    for (k = 0; k < 12; k++) GXSP_EACH_LANE(l) to[k][l] -= start[k % 3][l];
}

/* As gxsp_affine_bend */
static void gxsp_singles_bend(gxsp_singles *GXSP_RESTRICT way, gxsp_singles *GXSP_RESTRICT x,
                              gxsp_singles *GXSP_RESTRICT e) {
    int k, r, l;
    for (k = 0; k < 6; k++) {
        gxsp_singles *p = x + 12 + 9 * gxsp_edge_ends[k][0], *q = x + 12 + 9 * gxsp_edge_ends[k][1], *d = way + 3 * k;
        for (r = 0; r < 3; r++) GXSP_EACH_LANE(l)
        e[3 * k + r][l] = (p[r][l] - q[r][l]) * d[0][l] + (p[3 + r][l] - q[3 + r][l]) * d[1][l] +
                          (p[6 + r][l] - q[6 + r][l]) * d[2][l];
    }
}

/* As gxsp_affine_corners. shape: of the point */
static void gxsp_singles_corners(gxsp_singles *GXSP_RESTRICT shape, gxsp_singles *GXSP_RESTRICT x,
                                 gxsp_singles *GXSP_RESTRICT e, gxsp_singles *GXSP_RESTRICT w) {
    int j, r, l;
    for (j = 0; j < 4; j++) {
        const uint8_t *edge = gxsp_corner_edges[j], *other = gxsp_corner_others[j];
        for (r = 0; r < 3; r++) GXSP_EACH_LANE(l)
        w[3 * j + r][l] = x[3 * j + r][l] + shape[other[0]][l] * e[3 * edge[0] + r][l] +
                          shape[other[1]][l] * e[3 * edge[1] + r][l] + shape[other[2]][l] * e[3 * edge[2] + r][l];
    }
}

/* Adds mass x the point's motion to forces on w. mass: rate x 1/8 of the point's. y: as in gxsp_affine_inertia, half
 * of it: the other half is a force on w */
static void gxsp_singles_inertia(gxsp_singles *GXSP_RESTRICT shape, const float *GXSP_RESTRICT mass,
                                 gxsp_singles *GXSP_RESTRICT start, gxsp_singles *GXSP_RESTRICT x,
                                 gxsp_singles *GXSP_RESTRICT w, gxsp_singles *GXSP_RESTRICT y,
                                 gxsp_singles *GXSP_RESTRICT on_w) {
    gxsp_singles force[3];
    int r, j, l;
    for (r = 0; r < 3; r++) GXSP_EACH_LANE(l)
    force[r][l] =
        mass[l] * (start[r][l] +
                   0.125f * (shape[0][l] * (x[r][l] + w[r][l]) + shape[1][l] * (x[3 + r][l] + w[3 + r][l]) +
                             shape[2][l] * (x[6 + r][l] + w[6 + r][l]) + shape[3][l] * (x[9 + r][l] + w[9 + r][l])));
    for (j = 0; j < 4; j++)
        for (r = 0; r < 3; r++) GXSP_EACH_LANE(l) y[3 * j + r][l] += shape[j][l] * force[r][l];
    for (j = 0; j < 4; j++)
        for (r = 0; r < 3; r++) GXSP_EACH_LANE(l) on_w[3 * j + r][l] += shape[j][l] * force[r][l];
}

/* Forces on w at all points, 12 of each, to those on e: as gxsp_affine_collect. In one go, since compilers make no
 * vectors of sums in memory here */
static void gxsp_singles_collect(gxsp_singles *GXSP_RESTRICT shape, gxsp_singles *GXSP_RESTRICT w,
                                 gxsp_singles *GXSP_RESTRICT e) {
    int k, r, l;
    for (k = 0; k < 6; k++) {
        const int i = gxsp_edge_ends[k][0], j = gxsp_edge_ends[k][1];
        for (r = 0; r < 3; r++) {
            gxsp_singles *p = w + 3 * i + r, *q = w + 3 * j + r;
            GXSP_EACH_LANE(l)
            e[3 * k + r][l] = (((shape[i][l] * q[0][l] + shape[j][l] * p[0][l]) +
                                (shape[4 + i][l] * q[12][l] + shape[4 + j][l] * p[12][l])) +
                               (shape[8 + i][l] * q[24][l] + shape[8 + j][l] * p[24][l])) +
                              (shape[12 + i][l] * q[36][l] + shape[12 + j][l] * p[36][l]);
        }
    }
}

/* As gxsp_affine_return */
static void gxsp_singles_return(gxsp_singles *GXSP_RESTRICT way, gxsp_singles *GXSP_RESTRICT e,
                                gxsp_singles *GXSP_RESTRICT y) {
    int i, a, r, l;
    for (i = 0; i < 4; i++) {
        const uint8_t *edge = gxsp_corner_edges[i], *other = gxsp_corner_others[i];
        const float sign[3] = {i < other[0] ? 1.0f : -1.0f, i < other[1] ? 1.0f : -1.0f, i < other[2] ? 1.0f : -1.0f};
        for (a = 0; a < 3; a++)
            for (r = 0; r < 3; r++) GXSP_EACH_LANE(l)
        y[12 + 9 * i + 3 * a + r][l] = sign[0] * e[3 * edge[0] + r][l] * way[3 * edge[0] + a][l] +
                                       sign[1] * e[3 * edge[1] + r][l] * way[3 * edge[1] + a][l] +
                                       sign[2] * e[3 * edge[2] + r][l] * way[3 * edge[2] + a][l];
    }
}

/* As gxsp_affine_product, in single precision. y: 48 */
static void gxsp_singles_product(const gxsp_pass *pass, const gxsp_affine_block *block, gxsp_singles *y) {
    gxsp_singles shape[16], way[18], x[48], start[3], bend[18], forces[18], w[12], from[12], on_w[48];
    float mass[GXSP_LANES];
    int p, k, l;
    gxsp_affine_round(block, shape, way);
    gxsp_singles_gather(block, (const gxsp_vector4 *)pass->x, x, start);
    gxsp_singles_bend(way, x, bend);
    GXSP_EACH_LANE(l) mass[l] = (float)(0.125 * pass->rate * block->rest.mass[l]);
    memset(y, 0, 12 * sizeof *y);
    memset(on_w, 0, sizeof on_w);
    for (p = 0; p < 4; p++) {
        gxsp_singles *to = on_w + 12 * p;
        gxsp_singles_corners(shape + 4 * p, x, bend, w);
        for (k = 0; k < 12; k++) GXSP_EACH_LANE(l) from[k][l] = w[k][l] - w[k % 3][l];
        gxsp_kind_product(block->kind, &block->tangent[p], NULL, block->general ? &block->general[p] : NULL, 1, from,
                          to);
        if (pass->rate > 0) gxsp_singles_inertia(shape + 4 * p, mass, start, x, w, y, to);
        for (k = 0; k < 12; k++) GXSP_EACH_LANE(l) y[k][l] += to[k][l];
    }
    gxsp_singles_collect(shape, on_w, forces);
    gxsp_singles_return(way, forces, y);
}

/* Results of a block of the round under way */
static gxsp_singles *gxsp_singles_slots(const gxsp_affine *affine, size_t block) {
    return (gxsp_singles *)(void *)affine->slots + (block - affine->round) * 48;
}

static void gxsp_task_singles(void *context, size_t index) {
    const gxsp_pass *pass = (const gxsp_pass *)context;
    const gxsp_affine *affine = &pass->system->affine;
    const size_t first = affine->round + index * GXSP_AFFINE_TASK, end = first + GXSP_AFFINE_TASK;
    size_t b;
    for (b = first; b < end && b < affine->block_count; b++)
        if (!affine->blocks[b].still) gxsp_singles_product(pass, &affine->blocks[b], gxsp_singles_slots(affine, b));
}

/* Adds the results of a round to those of vectors. */
static void gxsp_singles_add(const gxsp_affine *affine, uint32_t end) {
    uint32_t b;
    int k, l;
    for (b = affine->round; b < end; b++) {
        const gxsp_affine_block *block = &affine->blocks[b];
        gxsp_singles *from = gxsp_singles_slots(affine, b);
        for (k = 0; k < 16 && !block->still; k++)
            for (l = 0; l < GXSP_LANES; l++) {
                double *to = affine->sum[block->vector[k][l] == GXSP_NONE ? 0 : block->vector[k][l]];
                if (block->vector[k][l] == GXSP_NONE) continue;
                to[0] += (double)from[3 * k][l], to[1] += (double)from[3 * k + 1][l],
                    to[2] += (double)from[3 * k + 2][l];
            }
    }
}

/* Adds the product of pass->x to pass->y, or takes it away if there is a pass->right. Returns x . product. */
static double gxsp_affine_multiply(gxsp_system *system, gxsp_pass *pass) {
    gxsp_affine *affine = &system->affine;
    double work = 0;
    size_t i;
    int k;
    memset(affine->sum, 0, system->model.n * sizeof *affine->sum);
    for (affine->round = 0; affine->round < affine->block_count; affine->round += GXSP_AFFINE_ROUND) {
        const uint32_t left = affine->block_count - affine->round,
                       count = left < GXSP_AFFINE_ROUND ? left : GXSP_AFFINE_ROUND;
        gxsp_parallel(system->jobs, (count + GXSP_AFFINE_TASK - 1) / GXSP_AFFINE_TASK, gxsp_task_singles, pass);
        gxsp_singles_add(affine, affine->round + count);
    }
    for (i = 0; i < system->model.n; i++)
        for (k = 0; k < 3 && !system->state.still[i]; k++) {
            work += (double)pass->x[i][k] * affine->sum[i][k];
            pass->y[i][k] += (float)(pass->right ? -affine->sum[i][k] : affine->sum[i][k]);
        }
    return work;
}

/* >>product: the Hessian times a vector, in single precision ------------------------------------------------------- */

/* In: the last linearisation and a vector. Out: the product on copies that follow nothing; what sleeps counts as
 * 0. */

static void gxsp_task_product(void *context, size_t index) {
    const gxsp_pass *pass = (const gxsp_pass *)context;
    const gxsp_system *system = pass->system;
    const gxsp_chunk *chunk = &system->mesh.chunks[index];
    const uint32_t *copies = system->mesh.nodes + chunk->first_node;
    const int near = chunk->node_count <= GXSP_NEAR;
    gxsp_vector4 in[GXSP_NEAR]; /* not the chunks' own memory: stays in the cache */
    gxsp_vector4 *out = (gxsp_vector4 *)(void *)system->vectors.slots + chunk->first_node;
    gxsp_singles from[12], to[12];
    uint32_t b, i;
    if (system->state.chunk_still[index]) return;
    for (i = 0; i < chunk->node_count && near; i++) {
        gxsp_prefetch(pass->x[copies[i + GXSP_AHEAD]], sizeof *pass->x);
        memcpy(in[i], pass->x[copies[i]], sizeof *in);
    }
    memset(out, 0, chunk->node_count * sizeof *out);
    memset(to, 0, sizeof to);
    for (b = 0; b < chunk->block_count; b++) {
        gxsp_prefetch_block(system, index, b, GXSP_TANGENTS_AHEAD, 1);
        if (near)
            gxsp_block_gather(chunk, b, (const gxsp_vector4 *)in, from);
        else
            gxsp_block_gather_copies(system, chunk, b, (const gxsp_vector4 *)pass->x, from);
        gxsp_kind_product(chunk->kind, &chunk->tangents[b], gxsp_block_moments(chunk, b), gxsp_block_general(chunk, b),
                          0, from, to);
        gxsp_block_scatter(chunk, b, to, out);
    }
}

/* y = product, from the slots, or right - product; and the sum of x . product */
static void gxsp_task_product_sum(void *context, size_t index) {
    const gxsp_pass *pass = (const gxsp_pass *)context;
    const gxsp_system *system = pass->system;
    gxsp_vector4 *slots = (gxsp_vector4 *)(void *)system->vectors.slots;
    size_t i, end = gxsp_range(system, index, &i);
    double work = 0;
    for (; i < end; i++) {
        const float *direction = pass->x[i],
                    m = gxsp_is_lumped(system) ? (float)(pass->rate * system->model.lumped[i]) : 0;
        const double *right = pass->right ? pass->right + 3 * i : NULL;
        float x = m * direction[0], y = m * direction[1], z = m * direction[2], *to = pass->y[i];
        uint32_t s;
        for (s = system->mesh.copy_start[i]; s < system->mesh.copy_start[i + 1] && !system->state.still[i]; s++) {
            const float *from = slots[system->mesh.copy_slot[s]];
            gxsp_prefetch(slots[system->mesh.copy_slot[s + GXSP_AHEAD]], sizeof *slots);
            x += from[0], y += from[1], z += from[2];
        }
        if (right)
            to[0] = (float)right[0] - x, to[1] = (float)right[1] - y, to[2] = (float)right[2] - z;
        else
            to[0] = x, to[1] = y, to[2] = z;
        work += (double)direction[0] * (double)x + (double)direction[1] * (double)y + (double)direction[2] * (double)z;
    }
    system->vectors.range_sum[index][0] = work;
}

/* y = A x by the assembled matrix, on copies that are not still. Returns x . y. */
static double gxsp_rows_product(const gxsp_system *system, gxsp_vector4 *x, gxsp_vector4 *y) {
    const gxsp_level *fine = &system->multigrid.levels[0];
    double work = 0;
    uint32_t i, k;
    int c;
    memset(y, 0, system->model.n * sizeof *y);
    for (i = 0; i < fine->n; i++) {
        gxsp_vector4 minus = {0, 0, 0, 0};
        const float minus_x[3] = {-x[i][0], -x[i][1], -x[i][2]};
        gxsp_subtract_block(fine->block + 9 * (size_t)fine->start[i], x[i], minus);
        for (k = fine->start[i] + 1; k < fine->start[i + 1]; k++) {
            gxsp_subtract_block(fine->block + 9 * (size_t)k, x[fine->column[k]], minus);
            gxsp_subtract_transposed(fine->block + 9 * (size_t)k, minus_x, y[fine->column[k]]);
        }
        for (c = 0; c < 3; c++) { /* all rows before have added to it */
            y[i][c] = system->state.still[i] ? 0 : y[i][c] - minus[c];
            work += (double)x[i][c] * (double)y[i][c];
        }
    }
    return work;
}

/* y += sign H x of one point; *work += x . H x */
static inline void gxsp_add_term(const gxsp_share *share, uint32_t count, const float *hessian, float sign,
                                 gxsp_vector4 *x, gxsp_vector4 *y, double *work) {
    float at[3] = {0, 0, 0}, force[3];
    uint32_t k;
    int c;
    for (k = 0; k < count; k++)
        for (c = 0; c < 3; c++) at[c] += share[k].weight * x[share[k].copy][c];
    gxsp_apply_packed(hessian, at, force);
    for (c = 0; c < 3; c++) *work += (double)at[c] * (double)force[c];
    for (k = 0; k < count; k++)
        for (c = 0; c < 3; c++) y[share[k].copy][c] += sign * share[k].weight * force[c];
}

/* The same for a pair: all four numbers of a vector at a time. The fourth ones of y stay as they are. */
static inline void gxsp_add_pair(const gxsp_share *share, uint32_t count, const float *hessian, float sign,
                                 gxsp_vector4 *x, gxsp_vector4 *y, double *work) {
    float at[4] = {0, 0, 0, 0}, force[4];
    uint32_t k;
    int c;
    for (k = 0; k < count; k++)
        for (c = 0; c < 4; c++) at[c] += share[k].weight * x[share[k].copy][c];
    gxsp_apply_packed(hessian, at, force);
    force[3] = 0;
    for (c = 0; c < 3; c++) *work += (double)at[c] * (double)force[c];
    for (c = 0; c < 3; c++) force[c] *= sign;
    for (k = 0; k < count; k++)
        for (c = 0; c < 4; c++) y[share[k].copy][c] += share[k].weight * force[c];
}

/* y += sign H x of springs and contact. Returns x . H x. */
static double gxsp_add_terms(const gxsp_lasting *lasting, float sign, gxsp_vector4 *x, gxsp_vector4 *y) {
    double work = 0;
    size_t t;
    for (t = 0; t < lasting->count; t++) {
        const gxsp_term *term = &lasting->term[t];
        const gxsp_share *share = lasting->share + term->first;
        if (term->assembled) continue;
        if (term->spread > 0 && term->count == 8)
            gxsp_add_pair(share, 8, term->hessian, sign, x, y, &work);
        else if (term->spread > 0)
            gxsp_add_pair(share, term->count, term->hessian, sign, x, y, &work);
        else if (term->count == 4) /* as a constant it is unrolled */
            gxsp_add_term(share, 4, term->hessian, sign, x, y, &work);
        else
            gxsp_add_term(share, term->count, term->hessian, sign, x, y, &work);
    }
    return work;
}

/* y = A x, or right - A x unless right is NULL, with A = scale (K + rate M), K the Hessian of the last
 * linearisation, on copies that follow nothing. x of followers is written too. right: 0 where nothing moves;
 * matrix-free only. Returns x . A x. */
static double gxsp_product_from(gxsp_system *system, double rate, const double *right, gxsp_vector4 *x,
                                gxsp_vector4 *y) {
    gxsp_pass pass;
    double work;
    memset(&pass, 0, sizeof pass);
    pass.system = system;
    pass.rate = system->model.scale * rate;
    pass.x = x;
    pass.y = y;
    pass.right = right;
    gxsp_extend(system, x);
    if (system->multigrid.fine)
        work = gxsp_rows_product(system, x, y);
    else {
        gxsp_parallel(system->jobs, system->mesh.chunk_count,
                      system->state.quick ? gxsp_task_strain_product : gxsp_task_product, &pass);
        gxsp_over_ranges(system, gxsp_task_product_sum, &pass, &work, 1);
        if (system->affine.count > 0) work += gxsp_affine_multiply(system, &pass);
    }
    work += gxsp_add_terms(system->lasting, right ? -1.0f : 1.0f, x, y);
    gxsp_reduce(system, y);
    return work;
}

/* y = A x; returns x . y */
static double gxsp_product(gxsp_system *system, double rate, gxsp_vector4 *x, gxsp_vector4 *y) {
    return gxsp_product_from(system, rate, NULL, x, y);
}

/* >>doubles: products of vectors in double precision, for gxs_solver_product --------------------------------------- */

/* In: the last linearisation and a direction. Out: the product, with what sleeps. Differences between an
 * element's corners are taken in double precision. */

/* The first three of four doubles minus those of origin, in single precision */
static inline void gxsp_narrow_four(const double *x, const double *origin, float *to) {
#if defined(GXSP_SHUFFLES)
    GXSP_STORE(to, GXSP_NARROW(x, origin));
#else
    int k;
    for (k = 0; k < 3; k++) to[k] = (float)(x[k] - origin[k]);
#endif
}

/* x of a block's corner 0, and of the others relative to it. Where neither corner has changed since the block
 * before, values are kept. in: x 3, and one more double */
static void gxsp_block_gather_doubles(const gxsp_chunk *chunk, uint32_t b, const double *GXSP_RESTRICT in,
                                      gxsp_singles *GXSP_RESTRICT to) {
    const gxsp_corners *corner = &chunk->corners[b];
    static const uint16_t own[GXSP_LANES] = {0, 1, 2, 3, 4, 5, 6, 7};
    static const double zero[4] = {0, 0, 0, 0};
    gxsp_vector4 lanes[GXSP_LANES];
    int i, l;
    for (i = 0; i < 4; i++) {
        if (!((chunk->changed[b] | chunk->changed[b] >> i) & 1)) continue;
        for (l = 0; l < GXSP_LANES; l++)
            gxsp_narrow_four(in + 3 * (size_t)corner->node[i][l], i > 0 ? in + 3 * (size_t)corner->node[0][l] : zero,
                             lanes[l]);
        gxsp_gather_eight(own, (const gxsp_vector4 *)lanes, to[3 * i], to[3 * i + 1], to[3 * i + 2]);
    }
}

/* The same, from the direction of all copies: see gxsp_copy_direction */
static GXSP_COLD void gxsp_block_gather_direction(const gxsp_pass *pass, const gxsp_chunk *chunk, uint32_t b,
                                                  gxsp_singles *to) {
    const uint32_t *copies = pass->system->mesh.nodes + chunk->first_node;
    const gxsp_corners *corner = &chunk->corners[b];
    int i, l, c;
    for (l = 0; l < GXSP_LANES; l++) {
        double origin[3] = {0, 0, 0}, x[3];
        for (i = 0; i < 4; i++) {
            gxsp_copy_direction(pass, copies[corner->node[i][l]], x);
            for (c = 0; c < 3; c++) to[3 * i + c][l] = (float)(x[c] - origin[c]);
            if (i == 0) memcpy(origin, x, sizeof origin);
        }
    }
}

/* The product of pass->from, times pass->factor, into the chunk's slots, 4 floats each */
static void gxsp_task_apply(void *context, size_t index) {
    const gxsp_pass *pass = (const gxsp_pass *)context;
    const gxsp_system *system = pass->system;
    const gxsp_chunk *chunk = &system->mesh.chunks[index];
    const uint32_t *copies = system->mesh.nodes + chunk->first_node;
    const int near = chunk->node_count <= GXSP_NEAR;
    gxsp_near in;
    gxsp_vector4 *out = (gxsp_vector4 *)(void *)system->vectors.slots + chunk->first_node;
    gxsp_singles from[12], to[12];
    uint32_t b, i;
    for (i = 0; i < chunk->node_count && near; i++) gxsp_copy_direction(pass, copies[i], in + 3 * (size_t)i);
    in[3 * (size_t)i] = 0;
    memset(out, 0, chunk->node_count * sizeof *out);
    memset(to, 0, sizeof to);
    for (b = 0; b < chunk->block_count; b++) {
        gxsp_prefetch_block(system, index, b, GXSP_TANGENTS_AHEAD, 1);
        if (near)
            gxsp_block_gather_doubles(chunk, b, in, from);
        else
            gxsp_block_gather_direction(pass, chunk, b, from);
        gxsp_kind_product(chunk->kind, &chunk->tangents[b], gxsp_block_moments(chunk, b), gxsp_block_general(chunk, b),
                          1, from, to);
        gxsp_block_scatter(chunk, b, to, out);
    }
}

/* pass->sum = the product, from the slots and from lumped masses */
static void gxsp_task_apply_sum(void *context, size_t index) {
    const gxsp_pass *pass = (const gxsp_pass *)context;
    const gxsp_system *system = pass->system;
    gxsp_vector4 *slots = (gxsp_vector4 *)(void *)system->vectors.slots;
    const double unit = 1 / system->model.scale, back = 1 / pass->factor;
    size_t i, end = gxsp_range(system, index, &i);
    for (; i < end; i++) {
        double direction[3] = {0, 0, 0}, mass = system->model.lumped_mass ? pass->rate * system->model.lumped[i] : 0, x,
               y, z;
        uint32_t s;
        if (mass > 0) gxsp_copy_direction(pass, (uint32_t)i, direction);
        x = mass * direction[0], y = mass * direction[1], z = mass * direction[2];
        for (s = system->mesh.copy_start[i]; s < system->mesh.copy_start[i + 1] && !system->model.fixed[i]; s++) {
            const float *from = slots[system->mesh.copy_slot[s]];
            gxsp_prefetch(slots[system->mesh.copy_slot[s + GXSP_AHEAD]], sizeof *slots);
            x += (double)from[0], y += (double)from[1], z += (double)from[2];
        }
        pass->sum[3 * i] = x * unit * back, pass->sum[3 * i + 1] = y * unit * back,
                      pass->sum[3 * i + 2] = z * unit * back;
    }
}

/* Adds the product of elements with affine copies to pass->sum. */
static void gxsp_affine_apply_all(gxsp_system *system, gxsp_pass *pass) {
    const double unit = 1 / (system->model.scale * pass->factor);
    double(*sum)[3] = system->affine.sum;
    uint32_t b;
    size_t i;
    int k;
    for (b = 0; b < system->affine.block_count; b++) system->affine.blocks[b].still = 0; /* what sleeps is included */
    memset(sum, 0, system->model.n * sizeof *sum);
    gxsp_over_affine(system, gxsp_task_affine_product, pass, sum[0]);
    for (i = 0; i < system->model.n; i++)
        for (k = 0; k < 3 && !system->model.fixed[i]; k++) pass->sum[3 * i + (size_t)k] += unit * sum[i][k];
    gxsp_mark_still_blocks(system);
}

/* Are the Hessians and masses of all elements finite? */
static int gxsp_tangents_finite(const gxsp_system *system) {
    uint32_t c;
    for (c = 0; c < system->mesh.chunk_count; c++) {
        const gxsp_chunk *chunk = &system->mesh.chunks[c];
        if (!gxsp_all_finite_single(chunk->tangents, chunk->block_count * sizeof *chunk->tangents) ||
            !gxsp_all_finite_single(chunk->generals,
                                    chunk->generals ? chunk->block_count * sizeof *chunk->generals : 0))
            return 0;
    }
    for (c = 0; c < system->affine.block_count; c++) {
        const gxsp_affine_block *block = &system->affine.blocks[c];
        if (!gxsp_all_finite_single(block->tangent, sizeof block->tangent) ||
            !gxsp_all_finite_single(block->general, block->general ? 4 * sizeof *block->general : 0))
            return 0;
    }
    return 1;
}

/* >>linearise: Hessians of elements, and the inverse block diagonal ------------------------------------------------ */

/* In: a displacement. Out: the tangents of all blocks, gxsp_vectors.diagonal, and whether an element has
 * collapsed. */

/* Adds the diagonal blocks of a block's Hessian, packed, to own[6 corner ...]. */
static void gxsp_block_diagonal(const gxsp_chunk *chunk, uint32_t b, gxsp_singles *own) {
    static const int diagonal[3] = {0, 3, 5};
    const gxsp_tangent *tangent = &chunk->tangents[b];
    gxsp_singles u[9];
    int corner, k, l;
    gxsp_block_frame(tangent, u);
    for (corner = 0; corner < 4; corner++) {
        gxsp_singles gamma[3], mass;
        gxsp_block_corner(tangent, corner, gamma);
        if (chunk->generals)
            gxsp_general_own(&chunk->generals[b], gamma, own + 6 * corner);
        else
            gxsp_block_own(tangent, u, gamma, own + 6 * corner);
        gxsp_block_mass(tangent, gxsp_block_moments(chunk, b), corner, corner, mass);
        for (k = 0; k < 3; k++) GXSP_EACH_LANE(l) own[6 * corner + diagonal[k]][l] += mass[l];
    }
}

/* Adds diagonal blocks to the chunk's slots, 6 floats each, and sets them to 0. Those of corners that the next
 * block has too are kept for it. */
static void gxsp_diagonal_scatter(const gxsp_chunk *chunk, uint32_t b, gxsp_singles *GXSP_RESTRICT own,
                                  float *GXSP_RESTRICT slots) {
    int corner, k, l;
    for (corner = 0; corner < 4; corner++) {
        if (!(chunk->changed[b + 1] >> corner & 1)) continue;
        for (l = 0; l < GXSP_LANES; l += 4)
            gxsp_scatter_six(chunk->corners[b].node[corner] + l, own + 6 * corner, l, slots);
        for (k = 6 * corner; k < 6 * corner + 6; k++) GXSP_EACH_LANE(l) own[k][l] = 0;
    }
}

/* Hessians of a chunk's blocks, and their diagonal blocks into the slots, which are 0. positions, state: as in
 * gxsp_blocks_state */
static GXSP_APART void gxsp_blocks_linearise(const gxsp_pass *pass, size_t index, const double *positions,
                                             const double *state) {
    gxsp_system *system = pass->system;
    const gxsp_chunk *chunk = &system->mesh.chunks[index];
    float *slots = (float *)(void *)system->vectors.slots[chunk->first_node];
    gxsp_lanes corners[12], x[12], made[2][9], *gradients[2];
    gxsp_singles own[24];
    const double rate = system->state.quick ? 0 : pass->rate; /* lumped mass is added to the sums */
    uint32_t b, k, blocks;
    int l;
    memset(own, 0, sizeof own);
    for (b = 0; b < chunk->block_count; b += blocks) { /* two at a time */
        gxsp_state s[2];
        gxsp_svd svd[2];
        blocks = b + 1 < chunk->block_count ? 2 : 1;
        for (k = 0; k < blocks; k++) {
            gxsp_prefetch_block(system, index, b + k, GXSP_RESTS_AHEAD, 0);
            gxsp_block_load(system, chunk, b + k, state, pass->from, x);
            gxsp_block_parameters(pass->materials, &chunk->rest[b + k], &s[k]);
            gradients[k] = gxsp_block_gradients(system, chunk, b + k, positions, corners, made[k]);
            gxsp_block_gradient(gradients[k], x, s[k].g);
        }
        system->state.chunk_collapsed[index] |=
            (uint8_t)gxsp_tangent_begin(chunk->kind, &s[0], blocks > 1 ? &s[1] : NULL, svd);
        for (k = 0; k < blocks; k++) {
            const gxsp_rest *rest = &chunk->rest[b + k];
            gxsp_tangent *tangent = &chunk->tangents[b + k];
            gxsp_tangent_make(chunk->kind, rest, gradients[k], system->model.scale, pass->exact, &s[k], &svd[k],
                              tangent, gxsp_block_general(chunk, b + k));
            GXSP_EACH_LANE(l) tangent->mass[l] = (float)(rate * rest->mass[l]);
            gxsp_block_diagonal(chunk, b + k, own);
            gxsp_diagonal_scatter(chunk, b + k, own, slots);
        }
    }
}

/* Hessian of a chunk at pass->from, and its diagonal blocks into the slots */
static void gxsp_task_linearise(void *context, size_t index) {
    const gxsp_pass *pass = (const gxsp_pass *)context;
    gxsp_system *system = pass->system;
    const gxsp_chunk *chunk = &system->mesh.chunks[index];
    const double *rest = NULL;
    gxsp_near positions, state;
    system->state.chunk_collapsed[index] = 0;
    if (system->state.chunk_still[index]) return;
    memset(system->vectors.slots[chunk->first_node], 0, chunk->node_count * sizeof *system->vectors.slots);
    if (!chunk->gradients) rest = gxsp_chunk_load(system, chunk, system->model.positions, positions);
    gxsp_blocks_linearise(pass, index, rest, gxsp_chunk_load(system, chunk, pass->from, state));
}

/* Inverse of a positive semi-definite 3x3, packed, in place, as W^T W with W the inverse Cholesky factor. So it is
 * semi-definite in spite of rounding. 1e-7 of the trace is added, since the entries are sums in single precision: a
 * direction without stiffness gives a large number, not an infinite one. Zero stays zero; such a copy is left alone.
 * Numbers that are not finite stay so. */
static void gxsp_invert3(double *a) {
    const double shift = 1e-7;
    double trace = a[0] + a[3] + a[5], scale, l00, l10, l20, l11, l21, l22, w10, w20, w21;
    if (!gxsp_finite(trace)) return;
    if (!(trace > 0)) {
        memset(a, 0, 6 * sizeof *a);
        return;
    }
    scale = 1 / trace;
    l00 = a[0] * scale + shift;
    l00 = 1 / sqrt(l00 > shift ? l00 : shift); /* reciprocals of the factor's diagonal */
    l10 = a[1] * scale * l00;
    l20 = a[2] * scale * l00;
    l11 = a[3] * scale + shift - l10 * l10;
    l11 = 1 / sqrt(l11 > shift ? l11 : shift);
    l21 = (a[4] * scale - l20 * l10) * l11;
    l22 = a[5] * scale + shift - l20 * l20 - l21 * l21;
    l22 = 1 / sqrt(l22 > shift ? l22 : shift);
    w10 = -l10 * l00 * l11;
    w21 = -l21 * l11 * l22;
    w20 = -(l20 * l00 + l21 * w10) * l22;
    a[0] = scale * (l00 * l00 + w10 * w10 + w20 * w20);
    a[1] = scale * (l11 * w10 + w21 * w20);
    a[2] = scale * l22 * w20;
    a[3] = scale * (l11 * l11 + w21 * w21);
    a[4] = scale * l22 * w21;
    a[5] = scale * l22 * l22;
}

static void gxsp_task_diagonal(void *context, size_t index) {
    const gxsp_pass *pass = (const gxsp_pass *)context;
    const gxsp_system *system = pass->system;
    const float *slots = (const float *)(const void *)system->vectors.slots;
    size_t i, end = gxsp_range(system, index, &i);
    for (; i < end; i++) {
        double sum[6] = {0, 0, 0, 0, 0, 0};
        uint32_t s;
        int k;
        for (s = system->mesh.copy_start[i]; s < system->mesh.copy_start[i + 1] && !system->state.still[i]; s++) {
            gxsp_prefetch(slots + 6 * (size_t)system->mesh.copy_slot[s + GXSP_AHEAD], 6 * sizeof *slots);
            for (k = 0; k < 6; k++) sum[k] += (double)slots[6 * (size_t)system->mesh.copy_slot[s] + (size_t)k];
        }
        for (k = 0; system->affine.count > 0 && k < 6 && !system->state.still[i]; k++)
            sum[k] += system->affine.own[i][k];
        for (k = 0; gxsp_is_lumped(system) && k < 6; k++)
            sum[k] += k == 0 || k == 3 || k == 5 ? pass->rate * system->model.lumped[i] : 0;
        if (system->state.still[i] || sum[0] + sum[3] + sum[5] < GXSP_TINY) /* only coarser levels move such a copy */
            memset(sum, 0, sizeof sum);
        gxsp_invert3(sum);
        for (k = 0; k < 6; k++) system->vectors.diagonal[6 * i + (size_t)k] = (float)sum[k];
    }
}

/* Adds springs, contact and followers to the diagonal blocks: to a copy's first slot, from which the blocks are
 * summed. With affine copies, >>rule has added the springs and contact. */
static void gxsp_extra_diagonal(gxsp_system *system) {
    float *slots = (float *)(void *)system->vectors.slots;
    size_t t;
    uint32_t i, s, n;
    int k, m;
    for (t = 0; t < system->lasting->count && system->affine.count == 0; t++)
        for (n = 0; n < system->lasting->term[t].count; n++) {
            const gxsp_term *term = &system->lasting->term[t];
            const gxsp_share *share = &system->lasting->share[term->first + n];
            const uint32_t copy = share->copy;
            for (m = 0; m < 6 && system->mesh.copy_start[copy] < system->mesh.copy_start[copy + 1]; m++)
                slots[6 * (size_t)system->mesh.copy_slot[system->mesh.copy_start[copy]] + (size_t)m] +=
                    gxsp_diagonal_share(term, share->weight) * term->hessian[m];
        }
    for (i = 0; i < system->model.follower_count; i++)
        for (s = system->mesh.copy_start[system->model.followers[i].copy];
             s < system->mesh.copy_start[system->model.followers[i].copy + 1]; s++)
            for (k = 0; k < 4; k++) {
                const uint32_t copy = system->model.followers[i].master[k];
                const float weight = (float)system->model.followers[i].weight[k];
                float *from = slots + 6 * (size_t)system->mesh.copy_slot[s];
                for (m = 0;
                     m < 6 && weight * weight > 0 && system->mesh.copy_start[copy] < system->mesh.copy_start[copy + 1];
                     m++)
                    slots[6 * (size_t)system->mesh.copy_slot[system->mesh.copy_start[copy]] + (size_t)m] +=
                        weight * weight * from[m];
            }
    for (i = 0; i < system->model.follower_count; i++)
        for (s = system->mesh.copy_start[system->model.followers[i].copy];
             s < system->mesh.copy_start[system->model.followers[i].copy + 1]; s++)
            memset(slots + 6 * (size_t)system->mesh.copy_slot[s], 0, 6 * sizeof *slots);
}

/* The pass that makes a step's Hessian */
static gxsp_pass gxsp_pass_of(gxsp_system *system, double rate, const double *from, int exact) {
    gxsp_pass pass;
    memset(&pass, 0, sizeof pass);
    pass.system = system;
    pass.materials = system->state.damped;
    pass.rate = system->model.scale * rate;
    pass.from = from;
    pass.exact = exact;
    return pass;
}

/* Hessian of the elements, times scale, and inverse block diagonal at a displacement. 0: a number overflowed. */
static int gxsp_linearise(gxsp_system *system, double rate, const double *from, int exact, int *collapsed) {
    gxsp_pass pass = gxsp_pass_of(system, rate, from, exact);
    size_t i;
    gxsp_parallel(system->jobs, system->mesh.chunk_count, gxsp_task_linearise, &pass);
    if (system->affine.count > 0) {
        gxsp_over_affine(system, gxsp_task_affine_tangents, &pass, NULL);
        gxsp_affine_diagonal(system, pass.rate);
    }
    gxsp_extra_diagonal(system);
    gxsp_over_ranges(system, gxsp_task_diagonal, &pass, NULL, 0);
    *collapsed = 0;
    for (i = 0; i < system->affine.block_count; i++) *collapsed |= system->affine.blocks[i].collapsed;
    if (!gxsp_all_finite_single(system->affine.root, system->affine.group_count * sizeof *system->affine.root))
        return 0;
    for (i = 0; i < system->mesh.chunk_count; i++) *collapsed |= system->state.chunk_collapsed[i];
    for (i = 0; i < 6 * system->model.n; i++)
        if (!gxsp_finite_single(system->vectors.diagonal[i])) return 0;
    return 1;
}

/* >>galerkin: numbers of the coarse matrices, transfer^T A transfer ------------------------------------------------ */

/* In: the last linearisation, or a level's matrix. Out: the next level's matrix. Level 1's is made chunk by chunk
 * from the elements, in shared memory, without an assembled matrix. */

/* Turns a block by rows into one by columns, for the row of the lower of the two nodes p and q, and adds its mass. */
static void gxsp_order_block(const uint16_t *GXSP_RESTRICT p, const uint16_t *GXSP_RESTRICT q,
                             const float *GXSP_RESTRICT mass, gxsp_singles *GXSP_RESTRICT block) {
    int l;
    GXSP_EACH_LANE(l) {
        const float b1 = block[1][l], b2 = block[2][l], b3 = block[3][l], b5 = block[5][l], b6 = block[6][l],
                    b7 = block[7][l];
        const int transposed = p[l] > q[l];
        block[0][l] += mass[l], block[4][l] += mass[l], block[8][l] += mass[l];
        block[1][l] = transposed ? b1 : b3, block[3][l] = transposed ? b3 : b1;
        block[2][l] = transposed ? b2 : b6, block[6][l] = transposed ? b6 : b2;
        block[5][l] = transposed ? b5 : b7, block[7][l] = transposed ? b7 : b5;
    }
}

/* Adds half the row sums of a block's masses to its nodes. */
static void gxsp_own_mass(gxsp_edges *edges, const gxsp_chunk *chunk, uint32_t b) {
    const gxsp_moments *moments = gxsp_block_moments(chunk, b);
    gxsp_singles corner[4], half;
    int k, l;
    for (k = 0; k < 4; k++) {
        if (moments) gxsp_corner_moments(moments, k, corner);
        GXSP_EACH_LANE(l)
        half[l] =
            chunk->rest[b].weight[l] > 0 ? (moments ? 0.5f * corner[0][l] : 2.5f) * chunk->tangents[b].mass[l] : 0;
        for (l = 0; l < GXSP_LANES; l++) edges->mass[chunk->corners[b].node[k][l]] += half[l];
    }
}

/* The edges of a chunk, with lists by node. Their numbers are 0. */
static void gxsp_edges_clear(gxsp_edges *edges, const gxsp_chunk *chunk) {
    uint32_t b, e;
    gxsp_edges_begin(edges, chunk);
    for (b = 0; b < chunk->block_count; b++) gxsp_block_edges(edges, chunk, b, edges->element[b]);
    memset(edges->first, 0, edges->nodes * sizeof *edges->first);
    memset(edges->joined, 0, edges->nodes);
    for (e = edges->count; --e > 0;) {
        const uint32_t low = edges->ends[e] >> 16, high = edges->ends[e] & 0xffff;
        edges->joined[low] = edges->joined[high] = 1;
        edges->next[e] = edges->first[low];
        edges->first[low] = (uint16_t)e;
    }
    memset(edges->block, 0, edges->count * sizeof *edges->block);
    memset(edges->own, 0, edges->nodes * sizeof *edges->own);
    memset(edges->mass, 0, edges->nodes * sizeof *edges->mass);
}

/* Blocks of a chunk's edges: the Hessian of its elements in i's row and j's column, with their mass; and the masses
 * of nodes */
static void gxsp_edge_blocks(gxsp_system *system, const gxsp_chunk *chunk) {
    gxsp_edges *edges = &system->multigrid.edges;
    uint32_t b;
    int pair, k, edge;
    gxsp_edges_clear(edges, chunk);
    for (b = 0; b < chunk->block_count; b++) {
        const gxsp_corners *corner = &chunk->corners[b];
        const gxsp_tangent *tangent = &chunk->tangents[b];
        gxsp_singles gamma[4][3];
        for (k = 0; k < 4; k++) gxsp_block_corner(tangent, k, gamma[k]);
        for (pair = edge = 0; pair < 10; pair++) {
            const int p = gxsp_pair_corners[pair][0], q = gxsp_pair_corners[pair][1];
            gxsp_singles block[9], mass;
            if (p == q) continue;
            gxsp_block_couple(tangent, gxsp_block_general(chunk, b), gamma[p], gamma[q], block);
            gxsp_block_mass(tangent, gxsp_block_moments(chunk, b), p, q, mass);
            gxsp_order_block(corner->node[p], corner->node[q], mass, block);
            gxsp_add_lanes(edges->element[b][edge++], block, edges->block);
        }
        gxsp_own_mass(edges, chunk, b);
    }
}

/* Entries of level 1's matrix for the pairs of a chunk's coarse nodes */
static void gxsp_pairs_find(gxsp_pairs *pairs, const gxsp_level *next) {
    const uint32_t count = pairs->count;
    uint32_t i, k;
    for (i = 1; i < count && count <= GXSP_CHUNK_PARENTS; i++)
        for (k = next->start[pairs->node[i]]; k < next->start[pairs->node[i] + 1]; k++) {
            const uint32_t column = next->column[k],
                           j = pairs->stamp[column] == pairs->round ? pairs->local[column] : 0;
            pairs->entry[j * count + i] = 2 * k + 1;
            pairs->entry[i * count + j] = 2 * k;
        }
}

/* The entry of one pair: see gxsp_pairs */
static uint32_t gxsp_pair_entry(const gxsp_pairs *pairs, const gxsp_level *next, uint32_t i, uint32_t j) {
    const uint32_t row = pairs->node[i], column = pairs->node[j];
    if (pairs->count <= GXSP_CHUNK_PARENTS) return pairs->entry[i * pairs->count + j];
    return row <= column ? 2 * gxsp_find_entry(next, row, column) : 2 * gxsp_find_entry(next, column, row) + 1;
}

/* Adds a block in node i's row and another node's column, times the transfer, to edges->half. count: numbers
 * touched so far. Returns how many are. */
static inline uint32_t gxsp_add_half(const gxsp_system *system, uint32_t i, uint32_t other, const float *weight,
                                     const float *block, uint32_t count) {
    const gxsp_edges *edges = &system->multigrid.edges;
    uint32_t *seen = system->multigrid.pairs.seen;
    int q;
    for (q = 0; q < 4; q++) {
        const uint16_t number = edges->parent[other][q];
        edges->touched[count] = number;
        count += seen[number] != i + 1;
        seen[number] = i + 1;
        gxsp_add_scaled(weight[q], block, edges->half[number]);
    }
    return count;
}

/* Node i's row of S times the transfer, in edges->half by number. The Hessian is S + S^T: S has the edges to higher
 * nodes and half the diagonal. Rows of stiffness add up to 0, so half the diagonal is half the mass minus half the sum
 * of the node's edges, transposed or not. Returns how many numbers are touched. */
static uint32_t gxsp_half_row(gxsp_system *system, const uint32_t *copies, uint32_t i) {
    const gxsp_level *fine = &system->multigrid.levels[0];
    gxsp_edges *edges = &system->multigrid.edges;
    uint32_t e, count = 0;
    system->multigrid.pairs.seen[0] = i + 1;
    for (e = edges->first[i]; e != 0; e = edges->next[e]) {
        const uint32_t other = edges->ends[e] & 0xffff;
        gxsp_add_scaled(-0.5f, edges->block[e], edges->own[i]);
        gxsp_add_scaled(-0.5f, edges->block[e], edges->own[other]);
        count = gxsp_add_half(system, i, other, fine->weight[copies[other]], edges->block[e], count);
    }
    gxsp_add_mass(edges->mass[i], edges->own[i]);
    return gxsp_add_half(system, i, i, fine->weight[copies[i]], edges->own[i], count);
}

/* Adds a node's contribution to level 1's matrix. A coarse node's own entry only gets half, to which its transpose
 * is added later. dirty: only entries in rows or columns of dirty nodes */
static void gxsp_coarse_node(gxsp_system *system, const uint32_t *copies, uint32_t i, const uint8_t *dirty) {
    const float *weight = system->multigrid.levels[0].weight[copies[i]];
    const gxsp_pairs *pairs = &system->multigrid.pairs;
    gxsp_level *next = &system->multigrid.levels[1];
    uint32_t p, t, count;
    if (!system->multigrid.edges.joined[i] && !(system->multigrid.edges.mass[i] > 0)) /* elements without weight have no
                                                                                         entries */
        return;
    count = gxsp_half_row(system, copies, i);
    for (t = 0; t < count; t++) {
        const uint32_t other = system->multigrid.edges.touched[t];
        float *half = system->multigrid.edges.half[other], transposed[9];
        gxsp_transpose_block(half, transposed);
        for (p = 0; p < 4; p++) {
            const uint32_t number = system->multigrid.edges.parent[i][p];
            if (number > 0 && (!dirty || dirty[pairs->node[number]] || dirty[pairs->node[other]])) {
                const uint32_t entry = gxsp_pair_entry(pairs, next, number, other);
                gxsp_add_scaled(weight[p], entry & 1 ? transposed : half, next->block + 9 * (size_t)(entry >> 1));
            }
        }
        memset(half, 0, sizeof transposed);
    }
}

/* Level 1's matrix from the last linearisation. dirty: only the rows and columns of dirty nodes, whose blocks are 0
 * before; NULL: all */
static void gxsp_coarse_elements(gxsp_system *system, const uint8_t *dirty) {
    gxsp_level *next = &system->multigrid.levels[1];
    uint32_t c, i;
    for (c = 0; c < system->mesh.chunk_count; c++) {
        const gxsp_chunk *chunk = &system->mesh.chunks[c];
        if (dirty && !chunk->dirty) continue;
        gxsp_edge_blocks(system, chunk);
        gxsp_pairs_begin(system, chunk);
        gxsp_pairs_find(&system->multigrid.pairs, next);
        for (i = 0; i < chunk->node_count; i++)
            gxsp_coarse_node(system, system->mesh.nodes + chunk->first_node, i, dirty);
    }
    for (i = 0; i < next->n; i++)
        if (!dirty || dirty[i]) {
            float *own = next->block + 9 * (size_t)next->start[i], transposed[9];
            gxsp_transpose_block(own, transposed);
            gxsp_add_scaled(1, transposed, own);
        }
}

/* A node's row, its own block halved, times the transfer, in pairs->half by node of the next level. pairs->node
 * lists the touched ones. Returns how many there are. */
static uint32_t gxsp_level_half_row(const gxsp_level *level, gxsp_pairs *pairs, uint32_t i) {
    uint32_t k, b, count = 0;
    int m;
    for (k = level->start[i]; k < level->start[i + 1]; k++)
        for (b = 0; b < 4; b++) {
            const uint32_t other = level->column[k], parent = level->parent[other][b];
            const float *block = level->block + 9 * (size_t)k,
                        weight = level->weight[other][b] * (other == i ? 0.5f : 1.0f);
            if (parent == GXSP_NONE) continue;
            if (pairs->seen[parent] == i + 1)
                gxsp_add_scaled(weight, block, pairs->half[parent]);
            else {
                pairs->seen[parent] = i + 1;
                pairs->node[count++] = parent;
                for (m = 0; m < 9; m++) pairs->half[parent][m] = weight * block[m];
            }
        }
    return count;
}

/* next's matrix = transfer^T A transfer = S + S^T, with S from A's upper half */
static void gxsp_coarsen(const gxsp_level *level, gxsp_level *next, gxsp_pairs *pairs) {
    uint32_t i, a, t, count;
    memset(next->block, 0, 9 * (size_t)next->start[next->n] * sizeof *next->block);
    memset(pairs->seen, 0, next->n * sizeof *pairs->seen);
    for (i = 0; i < level->n; i++) {
        count = gxsp_level_half_row(level, pairs, i);
        for (a = 0; a < 4; a++)
            for (t = 0; t < count && level->parent[i][a] != GXSP_NONE; t++) {
                const uint32_t row = level->parent[i][a], column = pairs->node[t];
                const float weight = level->weight[i][a], *half = pairs->half[column];
                float transposed[9];
                if (row <= column)
                    gxsp_add_scaled(weight, half, next->block + 9 * (size_t)gxsp_find_entry(next, row, column));
                if (row < column) continue;
                gxsp_transpose_block(half, transposed);
                gxsp_add_scaled(weight, transposed, next->block + 9 * (size_t)gxsp_find_entry(next, column, row));
            }
    }
}

/* Lumped masses between coarse functions */
static void gxsp_coarse_lumped(gxsp_system *system, double rate) {
    const gxsp_level *fine = &system->multigrid.levels[0];
    gxsp_level *next = &system->multigrid.levels[1];
    uint32_t i;
    int p, q;
    for (i = 0; i < fine->n; i++)
        for (p = 0; p < 4; p++)
            for (q = 0; q < 4; q++)
                if (fine->parent[i][p] <= fine->parent[i][q] && fine->parent[i][q] != GXSP_NONE)
                    gxsp_add_mass((float)(rate * system->model.lumped[i]) * fine->weight[i][p] * fine->weight[i][q],
                                  next->block +
                                      9 * (size_t)gxsp_find_entry(next, fine->parent[i][p], fine->parent[i][q]));
}

/* Parents of a copy on level 1 and their weights. Returns how many. */
static uint32_t gxsp_coarse_parents(const gxsp_system *system, uint32_t copy, uint32_t *parents, float *weights) {
    const gxsp_level *fine = &system->multigrid.levels[0];
    uint32_t count = 0;
    int p;
    if (system->affine.count > 0) return gxsp_nested_parents(system, copy, parents, weights);
    for (p = 0; p < 4; p++)
        if (fine->parent[copy][p] != GXSP_NONE) {
            parents[count] = fine->parent[copy][p];
            weights[count++] = fine->weight[copy][p];
        }
    return count;
}

/* The side of a pair that a vector of it is on, by the sign: hidden ones are on that of their copy. */
static float gxsp_side_of(const gxsp_system *system, const gxsp_share *share, uint32_t count, uint32_t i) {
    uint32_t j;
    if (!gxsp_is_hidden(system, share[i].copy)) return share[i].weight;
    for (j = 0; j < count; j++)
        if (share[j].copy == system->affine.member[system->affine.place[share[i].copy] / 4][0]) return share[j].weight;
    return 1;
}

/* What a pair's copies of one sign, or all of them (sign 0), are between coarse functions: nodes of level 1 with the
 * sums of their weights, in the order of their numbers. Returns how many. */
static uint32_t gxsp_coarse_shares(const gxsp_system *system, const gxsp_share *share, uint32_t count, int sign,
                                   uint32_t *node, float *weight) {
    uint32_t found = 0, i, j, p, parents[16], parent_count;
    float weights[16];
    for (i = 0; i < count; i++) {
        const float side = sign == 0 ? 0 : gxsp_side_of(system, share, count, i);
        if ((sign > 0 && side < 0) || (sign < 0 && side > 0)) continue;
        parent_count = gxsp_coarse_parents(system, share[i].copy, parents, weights);
        for (p = 0; p < parent_count; p++) {
            for (j = 0; j < found && node[j] != parents[p]; j++) {}
            if (j == found) node[found] = parents[p], weight[found++] = 0;
            weight[j] += share[i].weight * weights[p];
        }
    }
    for (i = 1; i < found; i++) {
        const uint32_t number = node[i];
        const float sum = weight[i];
        for (j = i; j > 0 && node[j - 1] > number; j--) node[j] = node[j - 1], weight[j] = weight[j - 1];
        node[j] = number, weight[j] = sum;
    }
    return found;
}

/* Adds factor x a block to an entry of level 1's matrix: where copies are affine, to its part in double precision. */
static inline void gxsp_add_coarse(gxsp_system *system, uint32_t entry, float factor, const float block[9]) {
    int k;
    if (system->affine.count > 0)
        for (k = 0; k < 9; k++)
            system->affine.block[9 * (size_t)entry + (size_t)k] += (double)factor * (double)block[k];
    else
        gxsp_add_scaled(factor, block, system->multigrid.levels[1].block + 9 * (size_t)entry);
}

/* Adds factor x the outer product of weights times a block to level 1's matrix, if that has all the entries it
 * needs. Returns whether it has. */
static int gxsp_add_outer(gxsp_system *system, const uint32_t *node, const float *weight, uint32_t count, float factor,
                          const float block[9]) {
    const gxsp_level *level = &system->multigrid.levels[1];
    uint32_t i, j, entry;
    int adds;
    for (adds = 0; adds < 2; adds++)
        for (i = 0; i < count; i++)
            for (j = i, entry = level->start[node[i]]; j < count; j++) {
                while (entry < level->start[node[i] + 1] && level->column[entry] < node[j]) entry++;
                if (entry == level->start[node[i] + 1] || level->column[entry] != node[j]) return 0;
                if (adds) gxsp_add_coarse(system, entry, factor * weight[i] * weight[j], block);
            }
    return 1;
}

/* A pair between coarse functions. A part of its entries could be indefinite. So level 1 gets all of them; or, where
 * it has none between the two sides, twice each side's: (a - b)^2 <= 2 a^2 + 2 b^2; or, where it has not even those, a
 * diagonal that bounds them: (sum w_i x_i)^2 <= sum |w_j| sum |w_i| x_i^2. */
static void gxsp_coarse_pair(gxsp_system *system, const gxsp_term *term) {
    static const int full[9] = {0, 1, 2, 1, 3, 4, 2, 4, 5};
    const gxsp_share *share = system->lasting->share + term->first;
    uint32_t node[16 * GXS_POINT_MOST], count, i;
    float weight[16 * GXS_POINT_MOST], block[9];
    int sign;
    for (i = 0; i < 9; i++) block[i] = term->hessian[full[i]];
    count = gxsp_coarse_shares(system, share, term->count, 0, node, weight);
    if (gxsp_add_outer(system, node, weight, count, 1, block)) return;
    for (sign = -1; sign <= 1; sign += 2) {
        float spread = 0;
        count = gxsp_coarse_shares(system, share, term->count, sign, node, weight);
        if (gxsp_add_outer(system, node, weight, count, 2, block)) continue;
        for (i = 0; i < count; i++) spread += fabsf(weight[i]);
        for (i = 0; i < count; i++)
            gxsp_add_coarse(system, gxsp_find_entry(&system->multigrid.levels[1], node[i], node[i]),
                            2 * spread * fabsf(weight[i]), block);
    }
}

/* Springs and contact between coarse functions, where level 1's matrix has an entry for them */
static void gxsp_coarse_term(gxsp_system *system, const gxsp_term *term) {
    static const int full[9] = {0, 1, 2, 1, 3, 4, 2, 4, 5};
    const gxsp_level *fine = &system->multigrid.levels[0];
    const gxsp_share *share = system->lasting->share + term->first;
    gxsp_level *next = &system->multigrid.levels[1];
    uint32_t i, j, p, q;
    int k;
    if (term->spread > 0) {
        gxsp_coarse_pair(system, term);
        return;
    }
    for (i = 0; i < 4 * term->count; i++)
        for (j = 0; j < 4 * term->count; j++) {
            const uint32_t a = share[i / 4].copy, b = share[j / 4].copy, row = fine->parent[a][i % 4],
                           column = fine->parent[b][j % 4];
            uint32_t entry;
            p = i % 4, q = j % 4;
            if (row > column || column == GXSP_NONE) continue;
            entry = gxsp_find_entry(next, row, column);
            if (next->column[entry] != column) continue;
            for (k = 0; k < 9; k++)
                next->block[9 * (size_t)entry + (size_t)k] += share[i / 4].weight * share[j / 4].weight *
                                                              fine->weight[a][p] * fine->weight[b][q] *
                                                              term->hessian[full[k]];
        }
}

/* >>nesting: numbers of level 1 where copies are affine ------------------------------------------------------------ */

/* In: tangents of elements with affine copies, level 1's matrix from chunks. Out: the factor of their sum, in double
 * precision: bending is softer than the rounding and the shift of single precision. */

/* Adds an element's Hessian between its coarse functions. Some fields have many descriptions by affine copies: what is
 * between two of them moves nothing, and only rounding has a stiffness there. So each A_i is tied to the gradient
 * around it by a spring of GXSP_TIE of the element's stiffness. Where a sheet bends, both differ by the bend over an
 * element, so the matrix gets stiffer by about GXSP_TIE (h / thickness)^2. rate: times scale; dirty: see
 * gxsp_nested_pattern */
static void gxsp_nested_element(gxsp_system *system, const gxsp_affine_block *block, int l, double rate,
                                const uint8_t *dirty) {
    const gxsp_level *level = &system->multigrid.levels[1];
    uint32_t node[64], parents[16], count = 0, c, d, k, n;
    double share[64][16], gradient[64][3], value[64], flux[27];
    float weights[16], slack[64][4][3];
    int p, m;
    for (k = 0; k < 16; k++) {
        n = block->vector[k][l] == GXSP_NONE ? 0 : gxsp_nested_parents(system, block->vector[k][l], parents, weights);
        while (n-- > 0) count = gxsp_add_function(node, share, count, parents[n], k, (double)weights[n]);
    }
    for (p = 0; p < 4; p++) {
        const double tie = 0.25 * GXSP_TIE * gxsp_point_modulus(block, p, l);
        for (c = 0; c < count; c++) gxsp_point_function(block, p, l, share[c], gradient[c], &value[c]);
        for (c = 0; c < count; c++) gxsp_point_slack(block, system->affine.length, p, l, share[c], slack[c]);
        for (d = 0; d < count; d++) {
            gxsp_point_flux(block, p, l, gradient[d], flux);
            for (c = 0; c < count; c++) {
                double to[9] = {0, 0, 0, 0, 0, 0, 0, 0, 0}, *entry,
                       tied = rate * block->rest.mass[l] * value[c] * value[d];
                if (node[c] > node[d] || (dirty && !dirty[node[c]] && !dirty[node[d]])) continue;
                entry = system->affine.block + 9 * (size_t)gxsp_find_entry(level, node[c], node[d]);
                for (m = 0; m < 12; m++)
                    tied += tie * ((double)slack[c][m / 3][m % 3] * (double)slack[d][m / 3][m % 3]);
                gxsp_point_couple(gradient[c], flux, to);
                to[0] += tied, to[4] += tied, to[8] += tied;
                for (m = 0; m < 9; m++) entry[3 * (m % 3) + m / 3] += to[m];
            }
        }
    }
}

/* Row i of the factor in double precision: see gxsp_factor_row */
static double *gxsp_nested_row(const gxsp_system *system, uint32_t i) {
    const gxsp_factor *factor = &system->multigrid.factor;
    const uint32_t place = i / 3, r = i % 3;
    return system->affine.entry + (factor->row[place] + r * (size_t)(3 * place - factor->first[place] + 1) + (r == 2));
}

/* a . b in four sums side by side */
static double gxsp_double_dot(const double *a, const double *b, size_t count) {
    double sum[4] = {0, 0, 0, 0};
    size_t i, k;
    for (i = 0; i + 4 <= count; i += 4)
        for (k = 0; k < 4; k++) sum[k] += a[i + k] * b[i + k];
    for (; i < count; i++) sum[0] += a[i] * b[i];
    return (sum[0] + sum[2]) + (sum[1] + sum[3]);
}

/* A function: dots[3 r + c] = row r of a times row c of b in columns from ... end - 1, in as many sums side by side as
 * a vector has. b: three rows of `number`, which load makes a vector of doubles of. */
#if defined(GXSP_SHUFFLES)
#define GXSP_NINE_SUMS(load)                                                                                           \
    gxsp_doubles s0 = GXSP_NO_DOUBLES, s1 = s0, s2 = s0, s3 = s0, s4 = s0, s5 = s0, s6 = s0, s7 = s0, s8 = s0;         \
    for (; k + GXSP_DOUBLES <= end; k += GXSP_DOUBLES) {                                                               \
        const gxsp_doubles x = load(b[0] + k), y = load(b[1] + k), z = load(b[2] + k);                                 \
        const gxsp_doubles p = GXSP_LOAD_DOUBLES(a[0] + k), q = GXSP_LOAD_DOUBLES(a[1] + k),                           \
                           r = GXSP_LOAD_DOUBLES(a[2] + k);                                                            \
        GXSP_ADD_PRODUCT(s0, p, x), GXSP_ADD_PRODUCT(s1, p, y), GXSP_ADD_PRODUCT(s2, p, z);                            \
        GXSP_ADD_PRODUCT(s3, q, x), GXSP_ADD_PRODUCT(s4, q, y), GXSP_ADD_PRODUCT(s5, q, z);                            \
        GXSP_ADD_PRODUCT(s6, r, x), GXSP_ADD_PRODUCT(s7, r, y), GXSP_ADD_PRODUCT(s8, r, z);                            \
    }                                                                                                                  \
    dots[0] = GXSP_SUM_DOUBLES(s0), dots[1] = GXSP_SUM_DOUBLES(s1), dots[2] = GXSP_SUM_DOUBLES(s2);                    \
    dots[3] = GXSP_SUM_DOUBLES(s3), dots[4] = GXSP_SUM_DOUBLES(s4), dots[5] = GXSP_SUM_DOUBLES(s5);                    \
    dots[6] = GXSP_SUM_DOUBLES(s6), dots[7] = GXSP_SUM_DOUBLES(s7), dots[8] = GXSP_SUM_DOUBLES(s8);
#else
#define GXSP_NINE_SUMS(load) memset(dots, 0, 9 * sizeof *dots);
#endif
#define GXSP_NINE_DOTS(name, number, load)                                                                             \
    static void name(double *const *a, number *const *b, size_t from, size_t end, double *GXSP_RESTRICT dots) {        \
        size_t k = from;                                                                                               \
        GXSP_NINE_SUMS(load)                                                                                           \
        for (; k < end; k++) {                                                                                         \
            const double x = (double)b[0][k], y = (double)b[1][k], z = (double)b[2][k], p = a[0][k], q = a[1][k],      \
                         r = a[2][k];                                                                                  \
            dots[0] += p * x, dots[1] += p * y, dots[2] += p * z;                                                      \
            dots[3] += q * x, dots[4] += q * y, dots[5] += q * z;                                                      \
            dots[6] += r * x, dots[7] += r * y, dots[8] += r * z;                                                      \
        }                                                                                                              \
    }
GXSP_NINE_DOTS(gxsp_nine_dots, float, GXSP_WIDEN)
GXSP_NINE_DOTS(gxsp_nine_double_dots, double, GXSP_LOAD_DOUBLES)

/* As gxsp_factor_left, in place */
static void gxsp_nested_left(const gxsp_system *system, uint32_t i) {
    const gxsp_factor *factor = &system->multigrid.factor;
    const uint32_t first = factor->first[i / 3];
    double *own[3], *other[3], dots[9];
    uint32_t j, m, r;
    for (r = 0; r < 3; r++) own[r] = gxsp_nested_row(system, i + r);
    for (j = first; j < i; j += 3) {
        m = factor->first[j / 3] > first ? factor->first[j / 3] : first;
        for (r = 0; r < 3; r++) other[r] = gxsp_nested_row(system, j + r);
        gxsp_nine_double_dots(own, other, m, j, dots);
        for (r = 0; r < 3; r++) {
            double *sum = own[r] + j;
            sum[0] = (sum[0] - dots[3 * r]) * other[0][j];
            sum[1] = (sum[1] - dots[3 * r + 1] - other[1][j] * sum[0]) * other[1][j + 1];
            sum[2] = (sum[2] - dots[3 * r + 2] - other[2][j] * sum[0] - other[2][j + 1] * sum[1]) * other[2][j + 2];
        }
    }
}

/* A node's own columns in row i + r. 0: a number overflowed. */
static int gxsp_nested_own(const gxsp_system *system, uint32_t i, uint32_t r) {
    const uint32_t first = system->multigrid.factor.first[i / 3];
    double *row = gxsp_nested_row(system, i + r);
    const double own = row[i + r];
    double left;
    uint32_t j;
    for (j = i; j < i + r; j++) {
        const double *other = gxsp_nested_row(system, j);
        row[j] = (row[j] - gxsp_double_dot(other + first, row + first, j - first)) * other[j];
    }
    left = own * (1 + 1e-12) - gxsp_double_dot(row + first, row + first, j - first);
    row[j] = own < GXSP_TINY ? 0 : left > 1e-10 * own ? 1 / sqrt(left) : 0;
    return gxsp_finite(row[j]);
}

/* The sum of both matrices in the factor's envelope, then Cholesky; the diagonal, with 1e-12 more, is inverted. place:
 * n, scratch. 0: a number overflowed. */
static int gxsp_nested_factor(gxsp_system *system, uint32_t *place) {
    const gxsp_factor *factor = &system->multigrid.factor;
    const gxsp_level *level = &system->multigrid.levels[1];
    uint32_t i, k, r, c;
    memset(system->affine.entry, 0, factor->entry_count * sizeof(double));
    for (i = 0; i < level->n; i++) place[factor->order[i]] = i;
    for (i = 0; i < level->n; i++)
        for (k = level->start[i]; k < level->start[i + 1]; k++)
            for (r = 0; r < 3; r++)
                for (c = 0; c < 3; c++) {
                    const uint32_t row = 3 * place[i] + r, column = 3 * place[level->column[k]] + c;
                    const size_t number = 9 * (size_t)k + 3 * c + r;
                    gxsp_nested_row(system, column <= row ? row : column)[column <= row ? column : row] =
                        (double)level->block[number] + system->affine.block[number];
                }
    for (i = 0; i < factor->n; i += 3) {
        gxsp_nested_left(system, i);
        for (r = 0; r < 3; r++)
            if (!gxsp_nested_own(system, i, r)) return 0;
    }
    return 1;
}

/* All numbers of level 1 beside those of chunks, and its factor. dirty: coarse nodes whose numbers are new, without
 * springs and contact; NULL: all are. rate: times scale. 0: a number overflowed. */
static int gxsp_nested_numbers(gxsp_system *system, double rate, const uint8_t *dirty) {
    const gxsp_affine *affine = &system->affine;
    uint32_t b;
    size_t t;
    int l;
    if (!dirty) memset(affine->block, 0, gxsp_block_numbers(&system->multigrid.levels[1]) * sizeof(double));
    for (b = 0; b < affine->block_count; b++)
        for (l = 0; l < GXSP_LANES; l++)
            if (affine->blocks[b].rest.weight[l] > 0 &&
                (!dirty || gxsp_nested_dirty(system, &affine->blocks[b], l, dirty)))
                gxsp_nested_element(system, &affine->blocks[b], l, rate, dirty);
    for (t = 0; t < system->lasting->count && !dirty; t++) gxsp_coarse_pair(system, &system->lasting->term[t]);
    return gxsp_nested_factor(system, system->multigrid.pairs.local);
}

/* x = the factor's answer to b on level 1 */
static void gxsp_nested_solve(gxsp_system *system) {
    const gxsp_factor *factor = &system->multigrid.factor;
    gxsp_level *level = &system->multigrid.levels[1];
    double *x = factor->x;
    uint32_t i, j;
    for (i = 0; i < factor->n; i++) {
        const double *row = gxsp_nested_row(system, i);
        const uint32_t first = factor->first[i / 3];
        x[i] = ((double)level->b[factor->order[i / 3]][i % 3] - gxsp_double_dot(row + first, x + first, i - first)) *
               row[i];
    }
    for (i = factor->n; i-- > 0;) {
        const double *row = gxsp_nested_row(system, i);
        x[i] *= row[i];
        for (j = factor->first[i / 3]; j < i; j++) x[j] -= row[j] * x[i];
    }
    for (i = 0; i < factor->n; i++) level->x[factor->order[i / 3]][i % 3] = (float)x[i];
}

/* Between groups and hidden nodes: b of level 1 += transfer^T r, or, back, x of level 0 += transfer x. */
static void gxsp_nested_transfer(gxsp_system *system, int back) {
    const gxsp_affine *affine = &system->affine;
    gxsp_level *fine = &system->multigrid.levels[0], *next = fine + 1;
    uint32_t group;
    int k, a;
    for (group = 0; group < affine->group_count; group++)
        for (k = 0; k < 4; k++) {
            const uint32_t copy = affine->member[group][0], parent = fine->parent[copy][k];
            const float weight = fine->weight[copy][k];
            for (a = 0; a < 3 && parent != GXSP_NONE; a++) {
                const uint32_t hidden = affine->hidden[parent] + (uint32_t)a, own = affine->member[group][a + 1];
                const float offset = weight * affine->offset[group][k][a];
                gxsp_add_four(offset, back ? next->x[hidden] : fine->r[copy], back ? fine->x[copy] : next->b[hidden]);
                gxsp_add_four(weight, back ? next->x[hidden] : fine->r[own], back ? fine->x[own] : next->b[hidden]);
            }
        }
}

/* >>factor: the last level's Cholesky factor, and all numbers below level 0 ---------------------------------------- */

/* In: level 1's matrix. Out: the matrices and inverse diagonals of all levels, the factor of the last one. 0 is
 * returned if a number overflowed. */

/* Inverse of a symmetric block, packed; 0 where single precision has no inverse. Returns 0 if a number overflowed. */
static int gxsp_invert_block(const float *block, float *inverse) {
    static const int packed[6] = {0, 3, 6, 4, 7, 8};
    double sum[6];
    int k;
    for (k = 0; k < 6; k++) sum[k] = (double)block[packed[k]];
    if (sum[0] + sum[3] + sum[5] < GXSP_TINY) memset(sum, 0, sizeof sum);
    gxsp_invert3(sum);
    for (k = 0; k < 6; k++) {
        inverse[k] = (float)sum[k];
        if (!gxsp_finite_single(inverse[k])) return 0;
    }
    return 1;
}

/* Adds GXSP_SHIFT to the diagonal, of dirty nodes only unless dirty is NULL, and inverts it. 0: a number overflowed. */
static int gxsp_invert_diagonal(gxsp_level *level, const uint8_t *dirty) {
    uint32_t i;
    for (i = 0; i < level->n; i++) {
        float *block = level->block + 9 * (size_t)level->start[i];
        if (!dirty || dirty[i]) gxsp_add_mass(GXSP_SHIFT * (block[0] + block[4] + block[8]), block);
        if (level->inverse && !gxsp_invert_block(block, level->inverse + 6 * (size_t)i)) return 0;
    }
    return 1;
}

/* Copies a level's matrix into the lower half of the factor's envelope. place: n, scratch */
static void gxsp_fill_factor(gxsp_factor *factor, const gxsp_level *level, uint32_t *place) {
    uint32_t i, k, r, c;
    memset(factor->entry, 0, factor->entry_count * sizeof *factor->entry);
    for (i = 0; i < level->n; i++) place[factor->order[i]] = i;
    for (i = 0; i < level->n; i++)
        for (k = level->start[i]; k < level->start[i + 1]; k++)
            for (r = 0; r < 3; r++)
                for (c = 0; c < 3; c++) {
                    const uint32_t row = 3 * place[i] + r, column = 3 * place[level->column[k]] + c;
                    gxsp_factor_row(factor, column <= row ? row : column)[column <= row ? column : row] =
                        level->block[9 * (size_t)k + 3 * c + r];
                }
}

/* Columns of the factor to the left of a node's own, in its three rows from row i on */
static void gxsp_factor_left(gxsp_factor *factor, uint32_t i) {
    const uint32_t first = factor->first[i / 3], n = factor->n;
    float *own[3], *other[3];
    double *rows[3], dots[9];
    uint32_t j, m, r, c;
    for (r = 0; r < 3; r++) {
        own[r] = gxsp_factor_row(factor, i + r);
        rows[r] = factor->rows + r * (size_t)n;
        for (j = first; j <= i + r; j++) rows[r][j] = (double)own[r][j];
    }
    for (j = first; j < i; j += 3) {
        m = factor->first[j / 3] > first ? factor->first[j / 3] : first;
        for (c = 0; c < 3; c++) other[c] = gxsp_factor_row(factor, j + c);
        gxsp_nine_dots(rows, other, m, j, dots);
        for (r = 0; r < 3; r++) {
            double *sum = rows[r] + j;
            sum[0] = (sum[0] - dots[3 * r]) * (double)other[0][j];
            sum[1] = (sum[1] - dots[3 * r + 1] - (double)other[1][j] * sum[0]) * (double)other[1][j + 1];
            sum[2] = (sum[2] - dots[3 * r + 2] - (double)other[2][j] * sum[0] - (double)other[2][j + 1] * sum[1]) *
                     (double)other[2][j + 2];
            for (c = 0; c < 3; c++) own[r][j + c] = (float)sum[c];
        }
    }
}

/* A node's own columns in row i + r, once its other columns are known. 0: a number overflowed. */
static int gxsp_factor_own(gxsp_factor *factor, uint32_t i, uint32_t r) {
    const uint32_t first = factor->first[i / 3];
    float *row = gxsp_factor_row(factor, i + r);
    double *sum = factor->rows + r * (size_t)factor->n;
    const double own = sum[i + r], least = 0.5 * (double)GXSP_SHIFT * own;
    uint32_t j;
    for (j = i; j < i + r; j++) {
        const float *other = gxsp_factor_row(factor, j);
        sum[j] = (sum[j] - gxsp_long_dot(other + first, sum + first, j - first)) * (double)other[j];
        row[j] = (float)sum[j];
    }
    sum[j] -= gxsp_long_dot(row + first, sum + first, j - first);
    row[j] = own < GXSP_TINY ? 1 : sum[j] > least ? (float)(1 / sqrt(sum[j])) : 0;
    return gxsp_finite_single(row[j]);
}

/* Cholesky of the last level, node by node. Without rounding no pivot is below GXSP_SHIFT of its diagonal. A pivot
 * below half of that is rounding: coarse functions of components that are small beside the lattice are nearly alike.
 * Its unknown is left out, since any other pivot would let later entries grow without bound. Entries are single
 * precision, which leaves the product of the factors positive semi-definite; the rows at work are double. 0: a number
 * overflowed. */
static int gxsp_factorise(gxsp_factor *factor, const gxsp_level *level, uint32_t *place) {
    uint32_t i, r;
    gxsp_fill_factor(factor, level, place);
    for (i = 0; i < factor->n; i += 3) {
        gxsp_factor_left(factor, i);
        for (r = 0; r < 3; r++)
            if (!gxsp_factor_own(factor, i, r)) return 0;
    }
    return 1;
}

/* All numbers that follow from level 1's matrix. dirty: nodes of level 1 whose numbers are new; NULL: all are. 0: a
 * number overflowed. */
static int gxsp_lower_numbers(gxsp_system *system, const uint8_t *dirty) {
    uint32_t depth;
    for (depth = 1; depth < system->multigrid.level_count; depth++) {
        gxsp_level *level = &system->multigrid.levels[depth];
        if (!gxsp_invert_diagonal(level, depth == 1 ? dirty : NULL)) return 0;
        if (depth + 1 < system->multigrid.level_count) gxsp_coarsen(level, level + 1, &system->multigrid.pairs);
    }
    return gxsp_factorise(&system->multigrid.factor, &system->multigrid.levels[system->multigrid.level_count - 1],
                          system->multigrid.pairs.local);
}

/* The matrices of all coarse levels from the last linearisation. 0: a number overflowed. */
static int gxsp_coarse_numbers(gxsp_system *system, double rate) {
    gxsp_level *fine = &system->multigrid.levels[0];
    int finite;
    size_t t;
    gxsp_lend_memory(system);
    if (system->multigrid.fine)
        gxsp_coarsen(fine, fine + 1, &system->multigrid.pairs);
    else {
        memset(fine[1].block, 0, 9 * (size_t)fine[1].start[fine[1].n] * sizeof(float));
        gxsp_coarse_elements(system, NULL);
        if (gxsp_is_lumped(system)) gxsp_coarse_lumped(system, system->model.scale * rate);
    }
    for (t = 0; t < system->lasting->count; t++)
        if (!system->lasting->term[t].assembled && system->affine.count == 0)
            gxsp_coarse_term(system, &system->lasting->term[t]);
    if (system->affine.count > 0)
        finite = gxsp_invert_diagonal(fine + 1, NULL) && gxsp_nested_numbers(system, system->model.scale * rate, NULL);
    else
        finite = gxsp_lower_numbers(system, NULL);
    gxsp_return_memory(system);
    return finite;
}

/* >>assembly: the assembled matrix --------------------------------------------------------------------------------- */

/* In: the last linearisation. Out: levels[0].block and its inverse diagonal; GXS_MATRIX_ASSEMBLED only. */

/* Adds a corner pair's block, on and above the diagonal, where corners follow others. same: both corners are one */
static void gxsp_assemble_following(gxsp_system *system, uint32_t p, uint32_t q, int same, const float *block) {
    gxsp_level *fine = &system->multigrid.levels[0];
    uint32_t a[4], b[4];
    float wa[4], wb[4], transposed[9];
    const int a_count = gxsp_masters_of(system, p, a, wa), b_count = gxsp_masters_of(system, q, b, wb);
    int i, j;
    gxsp_transpose_block(block, transposed);
    for (i = 0; i < a_count; i++)
        for (j = 0; j < b_count; j++) {
            const uint32_t low = a[i] < b[j] ? a[i] : b[j], high = a[i] < b[j] ? b[j] : a[i];
            float *to = fine->block + 9 * (size_t)gxsp_find_entry(fine, low, high);
            if (same && a[i] > b[j]) /* its mirror is added in its own turn */
                continue;
            gxsp_add_scaled(wa[i] * wb[j], a[i] <= b[j] ? block : transposed, to);
            if (a[i] == b[j] && !same) gxsp_add_scaled(wa[i] * wb[j], transposed, to);
        }
}

/* Adds a block's elements. Each lane's corner pair adds to one entry, or to those of its masters. */
static void gxsp_assemble_block(gxsp_system *system, const gxsp_chunk *chunk, uint32_t b) {
    gxsp_level *fine = &system->multigrid.levels[0];
    const gxsp_corners *corner = &chunk->corners[b];
    const gxsp_tangent *tangent = &chunk->tangents[b];
    gxsp_singles gamma[4][3];
    int pair, l;
    for (l = 0; l < 4; l++) gxsp_block_corner(tangent, l, gamma[l]);
    for (pair = 0; pair < 10; pair++) {
        const int p = gxsp_pair_corners[pair][0], q = gxsp_pair_corners[pair][1];
        gxsp_singles block[9], masses;
        gxsp_block_couple(tangent, gxsp_block_general(chunk, b), gamma[p], gamma[q], block);
        gxsp_block_mass(tangent, gxsp_block_moments(chunk, b), p, q, masses);
        for (l = 0; l < GXSP_LANES; l++) {
            const uint32_t *copies = system->mesh.nodes + chunk->first_node,
                           entry = system->multigrid.fine[chunk->first_block + b].entry[pair][l];
            const uint32_t i = copies[corner->node[p][l]], j = copies[corner->node[q][l]];
            float own[9] = {0, 0, 0, 0, 0, 0, 0, 0, 0},
                  *to = entry == GXSP_NONE ? own : fine->block + 9 * (size_t)entry;
            gxsp_add_lane(block, l, entry != GXSP_NONE && i > j, masses[l], to);
            if (entry == GXSP_NONE)
                gxsp_assemble_following(system, i, j, p == q, own);
            else if (p != q && i == j) /* both corners follow one copy */
                gxsp_add_lane(block, l, 1, masses[l], to);
        }
    }
}

/* Adds a spring or contact, on and above the diagonal, if the matrix has all the entries it needs. Returns whether
 * it has. */
static int gxsp_assemble_term(gxsp_system *system, const gxsp_term *term) {
    static const int full[9] = {0, 1, 2, 1, 3, 4, 2, 4, 5};
    const gxsp_share *share = system->lasting->share + term->first, *end = share + term->count;
    gxsp_level *fine = &system->multigrid.levels[0];
    uint32_t a[4 * GXS_POINT_MOST], i, j, count = 0, entry;
    float w[4 * GXS_POINT_MOST];
    int k, adds;
    for (; share < end; share++)
        if (share->weight * share->weight > 0) {
            const uint32_t first = count;
            for (count += (uint32_t)gxsp_masters_of(system, share->copy, a + count, w + count), i = first; i < count;
                 i++)
                w[i] *= share->weight;
        }
    for (adds = 0; adds < 2; adds++)
        for (i = 0; i < count; i++)
            for (j = 0; j < count; j++) {
                if (a[i] > a[j]) continue;
                entry = gxsp_find_entry(fine, a[i], a[j]);
                if (fine->column[entry] != a[j]) return 0;
                for (k = 0; k < 9 && adds; k++)
                    fine->block[9 * (size_t)entry + (size_t)k] += w[i] * w[j] * term->hessian[full[k]];
            }
    return 1;
}

/* The assembled matrix from the last linearisation */
static void gxsp_assemble(gxsp_system *system, double rate) {
    gxsp_level *fine = &system->multigrid.levels[0];
    uint32_t c, b, i;
    size_t t;
    memset(fine->block, 0, 9 * (size_t)fine->start[fine->n] * sizeof(float));
    for (c = 0; c < system->mesh.chunk_count; c++)
        for (b = 0; b < system->mesh.chunks[c].block_count && !system->state.chunk_still[c]; b++)
            gxsp_assemble_block(system, &system->mesh.chunks[c], b);
    for (i = 0; i < fine->n && system->model.lumped_mass; i++) {
        uint32_t a[4], p, q;
        float w[4];
        const uint32_t count = (uint32_t)gxsp_masters_of(system, i, a, w);
        for (p = 0; p < count; p++)
            for (q = 0; q < count; q++)
                if (a[p] <= a[q])
                    gxsp_add_mass(w[p] * w[q] * (float)(rate * system->model.lumped[i]),
                                  fine->block + 9 * (size_t)gxsp_find_entry(fine, a[p], a[q]));
    }
    for (t = 0; t < system->lasting->count; t++)
        system->lasting->term[t].assembled = gxsp_assemble_term(system, &system->lasting->term[t]);
}

/* Inverse diagonal blocks of the assembled matrix with springs and contact, for block Gauss-Seidel; 0 where nothing
 * moves. Returns 0 if a number overflowed. */
static int gxsp_invert_fine(gxsp_system *system) {
    static const int packed[6] = {0, 3, 6, 4, 7, 8}, full[9] = {0, 1, 2, 1, 3, 4, 2, 4, 5};
    gxsp_level *fine = &system->multigrid.levels[0];
    uint32_t i, k;
    size_t t;
    int m;
    for (i = 0; i < fine->n; i++)
        for (m = 0; m < 6; m++)
            fine->inverse[6 * (size_t)i + (size_t)m] = fine->block[9 * (size_t)fine->start[i] + (size_t)packed[m]];
    for (t = 0; t < system->lasting->count; t++)
        for (k = 0; k < system->lasting->term[t].count && !system->lasting->term[t].assembled; k++) {
            const gxsp_term *term = &system->lasting->term[t];
            const gxsp_share *share = &system->lasting->share[term->first + k];
            for (m = 0; m < 6; m++)
                fine->inverse[6 * (size_t)share->copy + (size_t)m] +=
                    gxsp_diagonal_share(term, share->weight) * term->hessian[m];
        }
    for (i = 0; i < fine->n; i++) {
        float *inverse = fine->inverse + 6 * (size_t)i, block[9];
        for (m = 0; m < 9; m++) block[m] = system->state.still[i] || gxsp_follows(system, i) ? 0 : inverse[full[m]];
        if (!gxsp_invert_block(block, inverse)) return 0;
    }
    return 1;
}

/* >>smoother: its step length -------------------------------------------------------------------------------------- */

/* In: the last linearisation and its block diagonal. Out: gxsp_smoother. Uses the search and product vectors. The
 * sweeps themselves are in >>cycle; the first one of level 0 is gxsp_scale in >>cg. */

/* x = D^-1 y for the groups of affine copies. before += y . x as it was, after += y . x. */
static void gxsp_scale_directions(const gxsp_system *system, gxsp_vector4 *y, gxsp_vector4 *x, double *before,
                                  double *after) {
    uint32_t group;
    int k;
    for (group = 0; group < system->affine.group_count; group++) {
        const uint32_t *member = system->affine.member[group];
        double from[12], to[12];
        for (k = 0; k < 12; k++) from[k] = (double)y[member[k / 3]][k % 3];
        gxsp_affine_apply(&system->affine, group, from, to);
        for (k = 0; k < 12; k++) {
            *before += from[k] * (double)x[member[k / 3]][k % 3];
            *after += from[k] * to[k];
            x[member[k / 3]][k % 3] = (float)to[k];
        }
    }
}

/* Largest eigenvalue of D^-1 (K + rate M) on copies that are not still, by the power method from a start that
 * favours none; 0 if nothing moves */
static double gxsp_largest_eigenvalue(gxsp_system *system, double rate) {
    gxsp_vector4 *x = system->vectors.search, *y = system->vectors.product;
    uint32_t random = 1;
    size_t i;
    int c, round;
    double largest = 0;
    for (i = 0; i < system->model.n; i++)
        for (c = 0; c < 3; c++) {
            random = random * 1664525u + 1013904223u;
            x[i][c] = system->state.still[i] ? 0 : (float)(random >> 8) / 8388608.0f - 1;
        }
    for (round = 0; round < 6; round++) {
        double before = 0, after = 0;
        float scale;
        gxsp_product(system, rate, x, y);
        for (i = 0; i < system->model.n; i++) {
            float z[3];
            if (gxsp_is_grouped(system, i)) continue;
            gxsp_apply_packed(system->vectors.diagonal + 6 * i, y[i], z);
            for (c = 0; c < 3; c++) {
                before += (double)y[i][c] * (double)x[i][c];
                after += (double)y[i][c] * (double)z[c];
                x[i][c] = z[c];
            }
        }
        gxsp_scale_directions(system, y, x, &before, &after);
        if (!(before > 0) || !(after > 0)) break;
        largest = after / before;
        scale = (float)(1 / sqrt(after));
        for (i = 0; i < system->model.n; i++)
            for (c = 0; c < 3; c++) x[i][c] *= scale;
    }
    return largest;
}

/* The smoother's step length: 3/2 over the largest eigenvalue. Conjugate gradients prefer it to the 4/3 that damp
 * the upper half of the spectrum most. An eigenvalue a third larger would leave the cycle definite. */
static float gxsp_omega(const gxsp_system *system, double largest) {
    largest = largest > 0 ? 1.05 * largest : 4;
    if (largest > 4 && system->model.follower_count == 0) /* no element's own D^-1 K exceeds 4 */
        largest = 4;
    return (float)(1.5 / largest);
}

/* Shortens the step length if the cycle might become indefinite where updates have changed the operator. Elsewhere
 * the largest eigenvalue is no larger than it was. */
static void gxsp_renew_omega(gxsp_system *system, double rate) {
    double largest;
    uint32_t c, k;
    size_t i;
    for (i = 0; i < system->model.n; i++) system->state.still[i] |= !system->smoother.renewed[i];
    for (c = 0; c < system->mesh.chunk_count; c++) {
        uint8_t still = 1;
        for (k = 0; k < system->mesh.chunks[c].node_count; k++)
            still &= system->state.still[system->mesh.nodes[system->mesh.chunks[c].first_node + k]];
        system->state.chunk_still[c] |= still;
    }
    largest = gxsp_largest_eigenvalue(system, rate);
    if (GXSP_OMEGA < (double)system->smoother.found * largest) system->smoother.found = (float)(GXSP_OMEGA / largest);
    gxsp_mark_still(system);
}

/* The step length for the next solve */
static void gxsp_choose_omega(gxsp_system *system, double rate) {
    if (!(system->smoother.omega > 0))
        system->smoother.found = gxsp_omega(system, gxsp_largest_eigenvalue(system, rate));
    else if (system->smoother.any_renewed)
        gxsp_renew_omega(system, rate);
    system->smoother.any_renewed = 0;
    system->smoother.cautious -= system->smoother.cautious > 0;
    if (system->smoother.cautious == 0) system->smoother.omega = system->smoother.found;
}

/* Sets the step length that keeps the cycle definite at any state: no element's own D^-1 K exceeds 4, so no sum of
 * elements does. With followers it may; then the quotient counts. quotient: x . A x / x . D x of an x for which the
 * length was too large; 0: not known */
static void gxsp_shorten_omega(gxsp_system *system, double quotient) {
    const double largest = system->model.follower_count > 0 && 1.25 * quotient > 4 ? 1.25 * quotient : 4;
    system->smoother.omega = (float)(1.5 / largest);
    system->smoother.next_cautious = system->smoother.next_cautious > 0 ? system->smoother.next_cautious : GXSP_PAUSE;
    system->smoother.cautious = system->smoother.next_cautious;
    system->smoother.next_cautious += system->smoother.next_cautious < 1024 ? system->smoother.next_cautious : 0;
}

/* >>cycle: the V-cycle --------------------------------------------------------------------------------------------- */

/* In: the residual. Out: the preconditioned residual in gxsp_vectors.scaled. A level's matrix is stored as the
 * upper half of its block rows. Block Gauss-Seidel goes forward before the coarse correction and backward after
 * it, in the order of the nodes, so that the whole is symmetric. */

/* r = b minus the entries left of the diagonal times x. solve: x is solved for on the way, row by row */
static void gxsp_sweep_lower(gxsp_level *level, int solve) {
    uint32_t i, k;
    memcpy(level->r, level->b, level->n * sizeof *level->r);
    for (i = 0; i < level->n; i++) {
        if (solve) gxsp_apply_packed(level->inverse + 6 * (size_t)i, level->r[i], level->x[i]);
        for (k = level->start[i] + 1; k < level->start[i + 1]; k++)
            gxsp_subtract_transposed(level->block + 9 * (size_t)k, level->x[i], level->r[level->column[k]]);
    }
}

/* x from 0 by one forward sweep, for which only entries left of the diagonal count. The residual then is minus the
 * entries right of the diagonal times x. */
static void gxsp_sweep_forward(gxsp_level *level) {
    uint32_t i, k;
    gxsp_sweep_lower(level, 1);
    for (i = 0; i < level->n; i++) {
        gxsp_vector4 r = {0, 0, 0, 0};
        for (k = level->start[i] + 1; k < level->start[i + 1]; k++)
            gxsp_subtract_block(level->block + 9 * (size_t)k, level->x[level->column[k]], r);
        memcpy(level->r[i], r, 3 * sizeof(float));
    }
}

static void gxsp_sweep_backward(gxsp_level *level) {
    uint32_t i, k;
    int c;
    gxsp_sweep_lower(level, 0);
    for (i = level->n; i-- > 0;) {
        gxsp_vector4 r;
        float change[3];
        memcpy(r, level->r[i], sizeof r);
        for (k = level->start[i]; k < level->start[i + 1]; k++)
            gxsp_subtract_block(level->block + 9 * (size_t)k, level->x[level->column[k]], r);
        gxsp_apply_packed(level->inverse + 6 * (size_t)i, r, change);
        for (c = 0; c < 3; c++) level->x[i][c] += change[c];
    }
}

/* b of the next level = transfer^T r */
static void gxsp_restrict(const gxsp_level *level, gxsp_level *next) {
    uint32_t i;
    int k;
    memset(next->b, 0, next->n * sizeof *next->b);
    for (i = 0; i < level->n; i++)
        for (k = 0; k < 4; k++)
            if (level->parent[i][k] != GXSP_NONE)
                gxsp_add_four(level->weight[i][k], level->r[i], next->b[level->parent[i][k]]);
}

/* x += transfer x of the next level */
static void gxsp_prolong(gxsp_level *level, const gxsp_level *next) {
    uint32_t i;
    int k;
    for (i = 0; i < level->n; i++)
        for (k = 0; k < 4; k++)
            if (level->parent[i][k] != GXSP_NONE)
                gxsp_add_four(level->weight[i][k], next->x[level->parent[i][k]], level->x[i]);
}

/* x = (L L^T)^-1 b on the last level */
static void gxsp_factor_solve(const gxsp_factor *factor, gxsp_level *level) {
    uint32_t i, j;
    double *x = factor->x;
    for (i = 0; i < factor->n; i++) {
        const float *row = gxsp_factor_row(factor, i);
        const uint32_t first = factor->first[i / 3];
        const double sum =
            (double)level->b[factor->order[i / 3]][i % 3] - gxsp_long_dot(row + first, x + first, i - first);
        x[i] = sum * (double)row[i];
    }
    for (i = factor->n; i-- > 0;) {
        const float *row = gxsp_factor_row(factor, i);
        x[i] *= (double)row[i];
        for (j = factor->first[i / 3]; j < i; j++) x[j] -= (double)row[j] * x[i];
    }
    for (i = 0; i < factor->n; i++) level->x[factor->order[i / 3]][i % 3] = (float)x[i];
}

/* x = the multigrid's answer to b on levels[depth] and below. depth 0: only if level 0 is assembled */
static void gxsp_cycle(gxsp_system *system, uint32_t depth) {
    gxsp_level *level = &system->multigrid.levels[depth];
    if (system->affine.count > 0) {
        gxsp_nested_solve(system);
        return;
    }
    if (depth + 1 == system->multigrid.level_count) {
        gxsp_factor_solve(&system->multigrid.factor, level);
        return;
    }
    gxsp_sweep_forward(level);
    gxsp_restrict(level, level + 1);
    gxsp_cycle(system, depth + 1);
    gxsp_prolong(level, level + 1);
    gxsp_sweep_backward(level);
}

/* scaled += omega D^-1 product */
static void gxsp_task_smooth(void *context, size_t index) {
    const gxsp_system *system = ((const gxsp_pass *)context)->system;
    size_t i, end = gxsp_range(system, index, &i);
    for (; i < end; i++) {
        float y[3];
        if (gxsp_is_grouped(system, i)) continue;
        gxsp_apply_packed(system->vectors.diagonal + 6 * i, system->vectors.product[i], y);
        system->vectors.scaled[i][0] += system->smoother.omega * y[0];
        system->vectors.scaled[i][1] += system->smoother.omega * y[1];
        system->vectors.scaled[i][2] += system->smoother.omega * y[2];
    }
}

/* The same for the groups of affine copies */
static void gxsp_smooth_groups(const gxsp_system *system) {
    uint32_t group;
    int k;
    for (group = 0; group < system->affine.group_count; group++) {
        const uint32_t *member = system->affine.member[group];
        double from[12], to[12];
        for (k = 0; k < 12; k++) from[k] = (double)system->vectors.product[member[k / 3]][k % 3];
        gxsp_affine_apply(&system->affine, group, from, to);
        for (k = 0; k < 12; k++) system->vectors.scaled[member[k / 3]][k % 3] += system->smoother.omega * (float)to[k];
    }
}

/* scaled = V-cycle of the residual. Level 0 is smoothed by omega D^-1, already done once on entry (see gxsp_scale), or
 * by block Gauss-Seidel if it is assembled. In violent motion the largest eigenvalue may exceed the one for which omega
 * was found; a residual that grows in the cycle shows it. energy: residual . D^-1 residual; product: scratch */
static void gxsp_v_cycle(gxsp_system *system, double rate, double energy) {
    gxsp_level *fine = &system->multigrid.levels[0];
    gxsp_pass pass;
    double work;
    size_t i;
    fine->x = system->vectors.scaled, fine->b = system->vectors.right, fine->r = system->vectors.product;
    if (system->multigrid.fine) {
        for (i = 0; i < 3 * system->model.n; i++)
            system->vectors.right[i / 3][i % 3] = system->state.still[i / 3] ? 0 : (float)system->vectors.residual[i];
        gxsp_cycle(system, 0);
        return;
    }
    work = gxsp_product_from(system, rate, system->vectors.residual, fine->x, fine->r);
    if (work > GXSP_OMEGA * (double)system->smoother.omega * energy && system->smoother.cautious == 0) {
        const float before = system->smoother.omega;
        gxsp_shorten_omega(system, work / ((double)before * (double)before * energy));
        for (i = 0; i < 3 * system->model.n; i++) fine->x[i / 3][i % 3] *= system->smoother.omega / before;
        (void)gxsp_product_from(system, rate, system->vectors.residual, fine->x, fine->r);
    }
    gxsp_restrict(fine, fine + 1);
    if (system->affine.count > 0) gxsp_nested_transfer(system, 0);
    gxsp_cycle(system, 1);
    gxsp_prolong(fine, fine + 1);
    if (system->affine.count > 0) gxsp_nested_transfer(system, 1);
    (void)gxsp_product_from(system, rate, system->vectors.residual, fine->x, fine->r);
    memset(&pass, 0, sizeof pass);
    gxsp_over_ranges(system, gxsp_task_smooth, &pass, NULL, 0);
    gxsp_smooth_groups(system);
}

/* >>edits: which lanes an update changes --------------------------------------------------------------------------- */

/* In: a gxs_change. Out: elements in their lanes and nodes of chunks. Elements are replaced where they were;
 * further ones go to chunks at the end. Chunks in which nothing has changed only get the new numbers of their
 * copies. */

/* A lane whose element goes, comes or is replaced */
typedef struct gxsp_edit {
    uint32_t chunk, lane, group;
    uint32_t element; /* of the change, that takes the lane; GXSP_NONE: none does */
} gxsp_edit;

typedef struct gxsp_renewal {
    gxsp_system *system;
    gxsp_pool *scratch;
    const gxs_change *change;
    size_t before;       /* copies so far */
    uint32_t *successor; /* before: new number of a copy; GXSP_NONE: it is gone */
    uint8_t *touched;    /* change->copy_count: an element around the copy goes or comes */
    gxsp_edit *edits;    /* edit_count lanes of changed groups; then placed_count lanes of further elements */
    uint32_t edit_count, placed_count; /* see edits */
    gxsp_edit *bent; /* lanes of changed groups among elements with affine copies; chunk: their block */
    uint32_t bent_count, added_count;        /* added_count: elements of the change with affine copies */
    uint32_t *left, *left_class, left_count; /* left_count elements of the change that take no lane of their group, and
                                                their classes */
    uint8_t *alike;                          /* change->copy_count: the copy follows the same copies as before */
    int dear;                                /* level 1 has become too dear to be factored */
    gxsp_pass *linearised; /* see gxsp_fit_levels; NULL: a step will linearise before it needs Hessians */
} gxsp_renewal;

/* Groups that change: a bit for each, indexed by the low bits of their numbers */
typedef struct gxsp_filter {
    uint64_t bit[GXSP_FILTER / 64];
} gxsp_filter;

/* Does a group change? */
static int gxsp_changes(const gxs_change *change, const gxsp_filter *filter, uint32_t group) {
    size_t low = 0, high = change->group_count;
    if (!(filter->bit[group % GXSP_FILTER / 64] >> group % 64 & 1)) return 0;
    while (high - low > 1) {
        const size_t middle = low + (high - low) / 2;
        if (change->groups[middle] <= group)
            low = middle;
        else
            high = middle;
    }
    return change->groups[low] == group;
}

static void gxsp_filter_make(const gxs_change *change, gxsp_filter *filter) {
    size_t i;
    memset(filter, 0, sizeof *filter);
    for (i = 0; i < change->group_count; i++)
        filter->bit[change->groups[i] % GXSP_FILTER / 64] |= (uint64_t)1 << change->groups[i] % 64;
}

/* All lanes of the groups that change, in the order of groups, then of lanes */
static void gxsp_find_edits(gxsp_renewal *update) {
    const gxsp_system *system = update->system;
    gxsp_edit *found = NULL;
    gxsp_sorted *sorted, *other;
    gxsp_filter filter;
    uint32_t c, lane, pass, count = 0;
    size_t i;
    gxsp_filter_make(update->change, &filter);
    for (pass = 0; pass < 2 && update->change->group_count > 0; pass++) { /* count, then list */
        if (pass == 1 && !(found = (gxsp_edit *)gxsp_take(update->scratch, count, sizeof *found))) return;
        for (c = 0, count = 0; c < system->mesh.chunk_count; c++)
            for (lane = 0; lane < system->mesh.chunks[c].block_count * GXSP_LANES; lane++) {
                const uint32_t group = system->mesh.chunks[c].groups[lane];
                if (group == GXSP_NONE || !gxsp_changes(update->change, &filter, group)) continue;
                if (found) found[count].chunk = c, found[count].lane = lane, found[count].group = group;
                count++;
            }
    }
    sorted = (gxsp_sorted *)gxsp_take(update->scratch, count, sizeof *sorted);
    other = (gxsp_sorted *)gxsp_take(update->scratch, count, sizeof *other);
    update->edits =
        (gxsp_edit *)gxsp_take(update->scratch, count + update->change->element_count, sizeof *update->edits);
    if (update->scratch->failed) return;
    for (i = 0; i < count; i++) sorted[i].place = found[i].group, sorted[i].index = (uint32_t)i;
    if (count > 0) sorted = gxsp_sort(sorted, other, count);
    for (i = 0; i < count; i++) {
        update->edits[i] = found[sorted[i].index];
        update->edits[i].element = GXSP_NONE;
    }
    update->edit_count = count;
}

/* Will an element of the change have an affine copy? */
static int gxsp_will_bend(const gxs_change *change, const gxs_element *element) {
    int k;
    for (k = 0; k < 4 && change->affine; k++)
        if (change->affine[element->copy[k]] != GXS_NOT_AFFINE) return 1;
    return 0;
}

/* Class of an element of the change. Called before copies are moved */
static uint32_t gxsp_class_of(const gxsp_renewal *update, const gxs_element *element) {
    const gxsp_system *system = update->system;
    return gxsp_class(system->model.materials[element->material].kind, element, 0, system->model.positions,
                      update->change->origins);
}

/* Gives elements the lanes of their group, as far as these are of their class. */
static void gxsp_match_edits(gxsp_renewal *update) {
    const gxs_change *change = update->change;
    uint32_t first = 0, e, i;
    update->left = (uint32_t *)gxsp_take(update->scratch, change->element_count, sizeof(uint32_t));
    update->left_class = (uint32_t *)gxsp_take(update->scratch, change->element_count, sizeof(uint32_t));
    for (e = 0; e < change->element_count && !update->scratch->failed; e++) {
        const gxs_element *element = &change->elements[e];
        const uint32_t class_index = gxsp_class_of(update, element);
        if (gxsp_will_bend(change, element)) {
            update->added_count++;
            continue;
        }
        while (first < update->edit_count && update->edits[first].group < element->group) first++;
        for (i = first; i < update->edit_count && update->edits[i].group == element->group; i++)
            if (update->edits[i].element == GXSP_NONE &&
                update->system->mesh.chunks[update->edits[i].chunk].class_index == class_index)
                break;
        if (i < update->edit_count && update->edits[i].group == element->group)
            update->edits[i].element = e;
        else {
            update->left_class[update->left_count] = class_index;
            update->left[update->left_count++] = e;
        }
    }
}

/* Marks the coarse nodes that a copy, as of before the update, follows as dirty. */
static void gxsp_mark_parents(const gxsp_system *system, uint32_t copy) {
    int q;
    for (q = 0; q < 4 && system->multigrid.level_count > 0; q++) {
        const uint32_t parent = system->multigrid.levels[0].parent[copy][q];
        if (parent != GXSP_NONE) system->multigrid.dirty[parent] = 1;
    }
}

/* Touches a copy as of before the update. */
static void gxsp_touch_copy(const gxsp_renewal *update, uint32_t copy) {
    if (update->successor[copy] != GXSP_NONE) update->touched[update->successor[copy]] = 1;
    gxsp_mark_parents(update->system, copy);
}

/* Touches the copies around elements that go. */
static void gxsp_touch_removed(gxsp_renewal *update) {
    const gxsp_system *system = update->system;
    uint32_t i, copies[4];
    int k;
    for (i = 0; i < update->edit_count; i++) {
        const gxsp_edit *edit = &update->edits[i];
        gxsp_lane_copies(system, &system->mesh.chunks[edit->chunk], edit->lane / GXSP_LANES,
                         (int)(edit->lane % GXSP_LANES), copies);
        for (k = 0; k < 4; k++) gxsp_touch_copy(update, copies[k]);
    }
    for (i = 0; i < update->bent_count; i++)
        for (k = 0; k < 4; k++)
            gxsp_touch_copy(update, system->affine.blocks[update->bent[i].chunk].vector[k][update->bent[i].lane]);
}

static void gxsp_touch_added(const gxsp_renewal *update) {
    size_t e;
    int k;
    for (e = 0; e < update->change->element_count; e++)
        for (k = 0; k < 4; k++) update->touched[update->change->elements[e].copy[k]] = 1;
}

static void gxsp_empty_lane(const gxsp_chunk *chunk, uint32_t lane) {
    gxsp_rest *rest = &chunk->rest[lane / GXSP_LANES];
    const size_t l = lane % GXSP_LANES;
    int k;
    chunk->groups[lane] = GXSP_NONE;
    rest->weight[l] = rest->mass[l] = 0;
    for (k = 0; k < 9 && chunk->gradients; k++)
        chunk->gradients[lane / GXSP_LANES].entry[k][l] = 0; /* F = 1 wherever its corners are */
}

/* A new chunk at the end. No block is in use, but there is memory for all that a chunk can have. */
static gxsp_chunk *gxsp_open_chunk(gxsp_system *system, uint32_t class_index) {
    gxsp_pool *pool = &system->pool;
    gxsp_chunk *chunk;
    gxsp_chunk_room(system);
    if (pool->failed) return NULL;
    chunk = &system->mesh.chunks[system->mesh.chunk_count];
    memset(chunk, 0, sizeof *chunk);
    chunk->class_index = class_index;
    chunk->kind = (gxs_material_kind)(class_index / 4);
    chunk->block_count = GXSP_CHUNK_BLOCKS;
    chunk->open = 1;
    gxsp_blocks_make(pool, chunk, 1);
    gxsp_tangents_make(pool, chunk, 1);
    chunk->block_count = 0;
    if (pool->failed) return NULL;
    system->mesh.chunk_count++;
    return chunk;
}

/* The first free lane of a chunk from a lane on, or GXSP_NONE */
static uint32_t gxsp_free_lane(gxsp_chunk *chunk, uint32_t from) {
    uint32_t lane;
    for (lane = from; lane < chunk->block_count * GXSP_LANES; lane++)
        if (chunk->groups[lane] == GXSP_NONE) return lane;
    return chunk->block_count < GXSP_CHUNK_BLOCKS ? lane : GXSP_NONE;
}

/* Index of the last open chunk of a class, or chunk_count */
static uint32_t gxsp_find_open(const gxsp_system *system, uint32_t class_index) {
    uint32_t c;
    for (c = system->mesh.chunk_count; c-- > 0;)
        if (system->mesh.chunks[c].open && system->mesh.chunks[c].class_index == class_index) return c;
    return system->mesh.chunk_count;
}

/* Puts those elements of a class that took no lane of their group into its open chunk, or into new ones. */
static void gxsp_place_class(gxsp_renewal *update, uint32_t class_index) {
    gxsp_system *system = update->system;
    uint32_t i, l, c = gxsp_find_open(system, class_index), lane = 0;
    for (i = 0; i < update->left_count; i++) {
        gxsp_edit *edit = &update->edits[update->edit_count + update->placed_count];
        if (update->left_class[i] != class_index) continue;
        lane = c < system->mesh.chunk_count ? gxsp_free_lane(&system->mesh.chunks[c], lane) : GXSP_NONE;
        if (lane == GXSP_NONE) {
            c = system->mesh.chunk_count;
            lane = 0;
            if (!gxsp_open_chunk(system, class_index)) return;
        }
        /* its other lanes have no weight, but a valid material */
        if (lane == system->mesh.chunks[c].block_count * GXSP_LANES) {
            for (l = 0; l < GXSP_LANES; l++)
                system->mesh.chunks[c].rest[lane / GXSP_LANES].material[l] =
                    update->change->elements[update->left[i]].material;
            system->mesh.chunks[c].block_count++;
        }
        edit->chunk = c, edit->lane = lane, edit->element = update->left[i];
        gxsp_place_element(&system->mesh.chunks[c], &update->change->elements[edit->element], gxsp_own_order, lane, 0);
        update->placed_count++;
        lane++;
    }
}

/* Puts elements into their lanes. Corners and nodes stay as they were. */
static void gxsp_replace_elements(gxsp_renewal *update) {
    uint32_t i, class_index;
    for (i = 0; i < update->edit_count; i++) {
        const gxsp_edit *edit = &update->edits[i];
        const gxsp_chunk *chunk = &update->system->mesh.chunks[edit->chunk];
        if (edit->element == GXSP_NONE)
            gxsp_empty_lane(chunk, edit->lane);
        else
            gxsp_place_element(chunk, &update->change->elements[edit->element], gxsp_own_order, edit->lane, 0);
    }
    for (class_index = 0; class_index < 4 * (GXS_CUSTOM + 1) && !update->system->pool.failed; class_index++)
        gxsp_place_class(update, class_index);
}

/* Nodes of a chunk whose lanes have changed. edit: the chunk's first; next: the next edit of the same chunk. 0: an
 * element that stays has lost a copy. */
static int gxsp_renew_chunk(gxsp_renewal *update, gxsp_chunk *chunk, uint32_t edit, const uint32_t *next,
                            gxsp_numbers *numbers, uint32_t *nodes) {
    const gxsp_system *system = update->system;
    uint32_t copies[GXSP_CHUNK][4], lane, used = 0;
    int k;
    memset(copies, 0xff, sizeof copies);
    for (lane = 0; lane < chunk->block_count * GXSP_LANES && chunk->node_count > 0; lane++) {
        if (chunk->groups[lane] == GXSP_NONE) continue;
        gxsp_lane_copies(system, chunk, lane / GXSP_LANES, (int)(lane % GXSP_LANES), copies[lane]);
        for (k = 0; k < 4; k++) copies[lane][k] = update->successor[copies[lane][k]];
    }
    for (; edit != GXSP_NONE; edit = next[edit])
        if (update->edits[edit].element != GXSP_NONE)
            memcpy(copies[update->edits[edit].lane], update->change->elements[update->edits[edit].element].copy,
                   sizeof copies[0]);
    for (lane = 0; lane < chunk->block_count * GXSP_LANES; lane++)
        if (chunk->groups[lane] != GXSP_NONE) {
            used = lane + 1;
            for (k = 0; k < 4; k++)
                if (copies[lane][k] == GXSP_NONE) return 0;
        }
    chunk->block_count = (used + GXSP_LANES - 1) / GXSP_LANES;
    chunk->node_count = gxsp_number_nodes(copies, chunk->block_count * GXSP_LANES, numbers, nodes);
    chunk->edge_count = chunk->pair_count = 0;
    gxsp_set_corners(chunk, copies);
    return 1;
}

/* Joins nodes of a chunk by its elements. roots: by node, the least node that it is joined with */
static void gxsp_find_roots(const gxsp_chunk *chunk, uint16_t *roots) {
    uint32_t forest[GXSP_CHUNK * 4], i, lane;
    int k;
    for (i = 0; i < chunk->node_count; i++) forest[i] = i;
    for (lane = 0; lane < chunk->block_count * GXSP_LANES; lane++) {
        const gxsp_corners *corner = &chunk->corners[lane / GXSP_LANES];
        const size_t l = lane % GXSP_LANES;
        for (k = 1; k < 4 && chunk->groups[lane] != GXSP_NONE; k++)
            if (gxsp_lane_supports(chunk, lane, 0) || gxsp_lane_supports(chunk, lane, k))
                gxsp_join(forest, corner->node[0][l], corner->node[k][l]);
    }
    for (i = 0; i < chunk->node_count; i++) roots[i] = (uint16_t)gxsp_root(forest, i);
}

/* Nodes of all chunks. 0: an element that stays has lost a copy. */
static int gxsp_renew_nodes(gxsp_renewal *update) {
    gxsp_system *system = update->system;
    const size_t n = update->change->copy_count;
    const uint32_t edits = update->edit_count + update->placed_count;
    const size_t room = system->mesh.slot_count + 4 * (size_t)edits;
    uint32_t *first = (uint32_t *)gxsp_take(update->scratch, system->mesh.chunk_count, sizeof(uint32_t)), c, i;
    uint32_t *next = (uint32_t *)gxsp_take(update->scratch, edits, sizeof(uint32_t));
    uint32_t *nodes = (uint32_t *)gxsp_take(update->scratch, room, sizeof(uint32_t));
    uint16_t *roots = (uint16_t *)gxsp_take(update->scratch, room, sizeof(uint16_t));
    size_t count = 0;
    gxsp_numbers numbers;
    numbers.local = (uint32_t *)gxsp_take(update->scratch, n, sizeof(uint32_t));
    numbers.stamp = (uint32_t *)gxsp_take(update->scratch, n, sizeof(uint32_t));
    numbers.round = 0;
    if (update->scratch->failed) return 1;
    memset(first, 0xff, system->mesh.chunk_count * sizeof *first);
    for (i = edits; i-- > 0;) {
        next[i] = first[update->edits[i].chunk];
        first[update->edits[i].chunk] = i;
    }
    for (c = 0; c < system->mesh.chunk_count; c++) {
        gxsp_chunk *chunk = &system->mesh.chunks[c];
        const uint32_t before = chunk->first_node;
        if (first[c] != GXSP_NONE && !gxsp_renew_chunk(update, chunk, first[c], next, &numbers, nodes + count))
            return 0;
        for (i = 0; i < chunk->node_count && first[c] == GXSP_NONE; i++) {
            nodes[count + i] = update->successor[system->mesh.nodes[before + i]];
            if (nodes[count + i] == GXSP_NONE) return 0;
        }
        if (first[c] != GXSP_NONE || !system->mesh.roots_known)
            gxsp_find_roots(chunk, roots + count);
        else
            memcpy(roots + count, system->mesh.slot_root + before, chunk->node_count * sizeof *roots);
        chunk->first_node = (uint32_t)count;
        count += chunk->node_count;
    }
    gxsp_slots_room(system, count);
    if (system->pool.failed) return 1;
    memcpy(system->mesh.nodes, nodes, count * sizeof *nodes);
    memcpy(system->mesh.slot_root, roots, count * sizeof *roots);
    system->mesh.roots_known = 1;
    return 1;
}

/* >>affine-edits: elements with affine copies in an update --------------------------------------------------------- */

/* In: a gxs_change, copies in their new numbering. Out: groups, and the blocks of elements with affine copies. An
 * element takes any free lane of its kind: blocks have no nodes of their own, so that its place does not matter. */

/* The lanes that change */
static void gxsp_find_bent(gxsp_renewal *update) {
    const gxsp_affine *affine = &update->system->affine;
    gxsp_filter filter;
    uint32_t lane, pass, count = 0;
    gxsp_filter_make(update->change, &filter);
    for (pass = 0; pass < 2 && affine->count > 0 && update->change->group_count > 0; pass++) { /* count, then list */
        if (pass == 1 && !(update->bent = (gxsp_edit *)gxsp_take(update->scratch, count, sizeof *update->bent))) return;
        for (lane = count = 0; lane < affine->block_count * GXSP_LANES; lane++) {
            if (affine->groups[lane] == GXSP_NONE || !gxsp_changes(update->change, &filter, affine->groups[lane]))
                continue;
            if (pass == 1) {
                update->bent[count].chunk = lane / GXSP_LANES, update->bent[count].lane = lane % GXSP_LANES;
                update->bent[count].group = affine->groups[lane], update->bent[count].element = GXSP_NONE;
            }
            count++;
        }
    }
    update->bent_count = count;
}

/* A lane without element: no weight, no mass, no vectors; F = 1 */
static void gxsp_affine_empty(gxsp_affine_block *block, uint32_t l) {
    int k;
    for (k = 0; k < 16; k++) block->vector[k][l] = GXSP_NONE, block->shape[k / 4][k % 4][l] = 0;
    for (k = 0; k < 9; k++) block->gradient[k][l] = block->edge[k][l] = 0;
    block->rest.weight[l] = block->rest.mass[l] = 0;
}

/* Empties the lanes that change, and gives the others the new numbers of their vectors. 0: an element that stays has
 * lost one of them. */
static int gxsp_renew_blocks(const gxsp_renewal *update) {
    gxsp_affine *affine = &update->system->affine;
    uint32_t i, b, k;
    for (i = 0; i < update->bent_count; i++) {
        gxsp_affine_empty(&affine->blocks[update->bent[i].chunk], update->bent[i].lane);
        affine->groups[update->bent[i].chunk * GXSP_LANES + update->bent[i].lane] = GXSP_NONE;
    }
    for (b = 0; b < affine->block_count; b++)
        for (k = 0; k < 16 * GXSP_LANES; k++) {
            uint32_t *vector = &affine->blocks[b].vector[k / GXSP_LANES][k % GXSP_LANES];
            if (*vector == GXSP_NONE) continue;
            *vector = update->successor[*vector];
            if (*vector == GXSP_NONE) return 0;
        }
    return 1;
}

/* The vectors of a group are touched if one of them is. */
static void gxsp_touch_groups(const gxsp_renewal *update) {
    const gxsp_affine *affine = &update->system->affine;
    uint32_t group;
    for (group = 0; group < affine->group_count; group++) {
        const uint32_t *member = affine->member[group];
        if (update->touched[member[0]] | update->touched[member[1]] | update->touched[member[2]] |
            update->touched[member[3]])
            update->touched[member[0]] = update->touched[member[1]] = update->touched[member[2]] =
                update->touched[member[3]] = 1;
    }
}

/* Groups of the new copies. Those of copies that become affine begin with zeros. before: old numbering, see
 * gxsp_affine.place */
static void gxsp_renew_groups(const gxsp_renewal *update, const uint32_t *before) {
    gxsp_system *system = update->system;
    uint32_t group, k;
    gxsp_groups_room(system, gxsp_count_groups(update->change->affine, system->model.n));
    if (system->pool.failed) return;
    gxsp_groups_make(system, update->change->affine);
    for (group = 0; group < system->affine.group_count; group++)
        for (k = 1; k < 4; k++) {
            const uint32_t vector = system->affine.member[group][k],
                           from = before[update->change->origins[vector] >> 1];
            if (from != GXSP_NONE && (from & 3) > 0) continue;
            memset(system->vectors.current + 3 * (size_t)vector, 0, 3 * sizeof(double));
            memset(system->vectors.guess[0][vector], 0, sizeof(gxsp_vector4));
            memset(system->vectors.guess[1][vector], 0, sizeof(gxsp_vector4));
            if (system->multigrid.level_count == 0) continue;
            memset(system->coarse.displacement + 3 * (size_t)vector, 0, 3 * sizeof(double));
            memset(system->multigrid.levels[0].parent[vector], 0xff, sizeof system->multigrid.levels[0].parent[vector]);
            memset(system->multigrid.levels[0].weight[vector], 0, sizeof system->multigrid.levels[0].weight[vector]);
        }
    gxsp_touch_groups(update);
}

/* A free lane of a kind, from one on; behind all others if there is none. There is room. */
static uint32_t gxsp_affine_lane(gxsp_system *system, gxs_material_kind kind, uint32_t lane) {
    gxsp_affine *affine = &system->affine;
    for (; lane < affine->block_count * GXSP_LANES; lane++)
        if (affine->groups[lane] == GXSP_NONE && affine->blocks[lane / GXSP_LANES].kind == kind) return lane;
    (void)gxsp_affine_open(system, affine->block_count++, kind);
    return lane;
}

/* Puts the elements of the change that have affine copies into lanes. */
static void gxsp_place_bent(gxsp_renewal *update) {
    gxsp_system *system = update->system;
    gxsp_affine *affine = &system->affine;
    uint32_t e, l, lane[GXS_CUSTOM + 1] = {0, 0, 0, 0, 0};
    const uint32_t room = affine->block_count + update->added_count / GXSP_LANES + GXS_CUSTOM + 1;
    if (room > affine->block_room) {
        affine->block_room = (uint32_t)gxsp_room(room);
        affine->blocks = (gxsp_affine_block *)gxsp_grow(&system->pool, affine->blocks, affine->block_count,
                                                        affine->block_room, sizeof *affine->blocks);
        affine->groups = (uint32_t *)gxsp_grow(&system->pool, affine->groups, (size_t)affine->block_count * GXSP_LANES,
                                               (size_t)affine->block_room * GXSP_LANES, sizeof(uint32_t));
    }
    for (e = 0; e < update->change->element_count && !system->pool.failed; e++) {
        const gxs_element *element = &update->change->elements[e];
        const gxs_material_kind kind = system->model.materials[element->material].kind;
        gxsp_affine_block *block;
        if (!gxsp_will_bend(update->change, element)) continue;
        lane[kind] = gxsp_affine_lane(system, kind, lane[kind]);
        block = &affine->blocks[lane[kind] / GXSP_LANES];
        affine->groups[lane[kind]] = element->group;
        for (l = 0; l < GXSP_LANES; l++) /* a valid material of this kind */
            if (affine->groups[lane[kind] / GXSP_LANES * GXSP_LANES + l] == GXSP_NONE)
                block->rest.material[l] = element->material;
        gxsp_affine_fill(system, element, block, (int)(lane[kind] % GXSP_LANES));
    }
    affine->count += update->added_count;
    affine->count -= update->bent_count;
    gxsp_affine_results(system);
}

/* Does the element of a lane give corner k stiffness or mass? */
static int gxsp_affine_supports(const gxsp_affine_block *block, int l, int k) {
    return block->vector[0][l] != GXSP_NONE && (block->rest.weight[l] > 0 || gxsp_affine_mass(block, l, k) > 0);
}

/* Adds to masses of touched copies, and whether anything supports them. */
static void gxsp_recount_bent(const gxsp_renewal *update) {
    gxsp_system *system = update->system;
    const uint8_t *touched = update->touched;
    uint32_t b, group;
    int k, l;
    for (b = 0; b < system->affine.block_count; b++)
        for (l = 0; l < GXSP_LANES; l++) {
            const gxsp_affine_block *block = &system->affine.blocks[b];
            int any = 0;
            for (k = 0; k < 4 && block->vector[0][l] != GXSP_NONE; k++) {
                const uint32_t copy = block->vector[k][l];
                if (!touched[copy]) continue;
                any = 1;
                system->model.lumped[copy] += gxsp_affine_mass(block, l, k);
                system->model.fixed[copy] &= !gxsp_affine_supports(block, l, k);
            }
            if (any) gxsp_affine_lump(system, block, l, touched);
        }
    for (group = 0; group < system->affine.group_count; group++)
        for (k = 1; k < 4; k++)
            system->model.fixed[system->affine.member[group][k]] = system->model.fixed[system->affine.member[group][0]];
}

/* Joins what the elements and groups connect. forest: n */
static void gxsp_join_bent(const gxsp_system *system, uint32_t *forest) {
    uint32_t b;
    int k, l;
    for (b = 0; b < system->affine.block_count; b++)
        for (l = 0; l < GXSP_LANES; l++)
            for (k = 1; k < 4; k++) {
                const gxsp_affine_block *block = &system->affine.blocks[b];
                if (gxsp_affine_supports(block, l, 0) || gxsp_affine_supports(block, l, k))
                    gxsp_join(forest, block->vector[0][l], block->vector[k][l]);
            }
    gxsp_join_groups(system, forest);
}

/* >>renewal: copies and components after an update ----------------------------------------------------------------- */

/* In: new numbers of copies, touched copies. Out: the columns over copies in their new order, masses, followers,
 * light copies and components. */

/* The new number of each copy so far. 0: two copies have the same origin, or a copy is not held as before. */
static int gxsp_find_successors(gxsp_renewal *update) {
    const gxs_change *change = update->change;
    uint32_t i;
    memset(update->successor, 0xff, update->before * sizeof *update->successor);
    for (i = 0; i < change->copy_count; i++) {
        uint32_t *successor = &update->successor[change->origins[i] >> 1];
        if ((change->held && change->held[i]) != (update->system->model.held[change->origins[i] >> 1] != 0)) return 0;
        if (change->origins[i] & 1)
            update->touched[i] = 1;
        else if (*successor != GXSP_NONE)
            return 0;
        else
            *successor = i;
    }
    return 1;
}

/* Brings the columns over copies into the new numbering. */
static void gxsp_move_copies(gxsp_renewal *update) {
    gxsp_system *system = update->system;
    const gxs_change *change = update->change;
    uint32_t *moved = (uint32_t *)gxsp_take(update->scratch, change->copy_count, sizeof(uint32_t)), i;
    unsigned char *saved;
    size_t count = 0;
    gxsp_copies_room(system, change->copy_count);
    for (i = 0; i < change->copy_count && moved; i++)
        if (change->origins[i] >> 1 != i) moved[count++] = i;
    saved = (unsigned char *)gxsp_take(update->scratch, count, 3 * sizeof(double)); /* the largest entry */
    if (update->scratch->failed || system->pool.failed) return;
    gxsp_columns_move(system, change->origins, moved, count, saved);
    system->model.n = change->copy_count;
    system->model.epoch = change->epoch;
    system->multigrid.levels[0].n = (uint32_t)change->copy_count;
    system->model.range_count = (system->model.n + GXSP_RANGE - 1) / GXSP_RANGE;
}

/* Is a follower the same as before, but for the numbers of copies? */
static int gxsp_follows_alike(const gxsp_renewal *update, const gxsp_follower *follower,
                              const gxs_constraint *constraint) {
    const uint32_t *affine = update->change->affine;
    uint32_t count = 4;
    int k;
    for (k = 0; k < 4; k++) {
        if (update->successor[follower->master[k]] != constraint->master[k]) return 0;
        if (affine && affine[constraint->copy] != GXS_NOT_AFFINE && affine[constraint->master[k]] != GXS_NOT_AFFINE &&
            fabs(constraint->weight[k]) > 0)
            count += 3;
    }
    return follower->count == count && memcmp(follower->weight, constraint->weight, sizeof constraint->weight) == 0;
}

/* Touches copies that begin or cease to follow others, and their masters, and marks the coarse nodes of both as
 * dirty. Followers that are the same as before are left out. */
static void gxsp_touch_followers(gxsp_renewal *update) {
    const gxsp_system *system = update->system;
    const gxs_change *change = update->change;
    size_t i;
    int k;
    for (i = 0; i < change->constraint_count && system->model.follower_count > 0; i++) {
        const uint32_t copy = change->constraints[i].copy, origin = change->origins[copy];
        if (!(origin & 1) && gxsp_follows(system, origin >> 1))
            update->alike[copy] = (uint8_t)gxsp_follows_alike(
                update, &system->model.followers[system->model.follower[origin >> 1]], &change->constraints[i]);
    }
    for (i = 0; i < system->model.follower_count; i++) { /* followers before the update */
        const uint32_t copy = system->model.followers[i].copy;
        if (gxsp_is_hidden(system, copy)) continue; /* its copy is touched */
        if (update->successor[copy] != GXSP_NONE && update->alike[update->successor[copy]]) continue;
        for (k = -1; k < 4; k++) {
            const uint32_t other = k < 0 ? copy : system->model.followers[i].master[k];
            gxsp_touch_copy(update, other);
        }
    }
    for (i = 0; i < change->constraint_count; i++) /* followers from now on */
        for (k = -1; k < 4 && !update->alike[change->constraints[i].copy]; k++) {
            const uint32_t other = k < 0 ? change->constraints[i].copy : change->constraints[i].master[k],
                           origin = change->origins[other] >> 1;
            update->touched[other] = 1;
            gxsp_mark_parents(system, origin);
        }
}

/* Masses of touched copies, and whether anything supports them */
static void gxsp_recount_copies(const gxsp_renewal *update) {
    gxsp_system *system = update->system;
    const uint8_t *touched = update->touched;
    uint32_t c, i, lane, copies[4];
    int k;
    for (i = 0; i < system->model.n; i++)
        if (touched[i]) {
            system->model.lumped[i] = 0;
            system->model.fixed[i] = 1;
        }
    for (c = 0; c < system->mesh.chunk_count; c++) {
        const gxsp_chunk *chunk = &system->mesh.chunks[c];
        int any = 0;
        for (i = 0; i < chunk->node_count; i++) any |= touched[system->mesh.nodes[chunk->first_node + i]];
        for (lane = 0; lane < chunk->block_count * GXSP_LANES && any; lane++) {
            if (chunk->groups[lane] == GXSP_NONE) continue;
            gxsp_lane_copies(system, chunk, lane / GXSP_LANES, (int)(lane % GXSP_LANES), copies);
            for (k = 0; k < 4; k++)
                if (touched[copies[k]]) {
                    system->model.lumped[copies[k]] += gxsp_lane_mass(chunk, lane, k);
                    system->model.fixed[copies[k]] &= !gxsp_lane_supports(chunk, lane, k);
                }
        }
    }
    if (system->affine.count > 0) gxsp_recount_bent(update);
    for (i = 0; i < system->model.n; i++) system->model.fixed[i] |= system->model.held[i];
}

/* Light copies, in the new numbering */
static void gxsp_renew_lights(gxsp_renewal *update) {
    gxsp_system *system = update->system;
    uint32_t i, count = 0;
    for (i = 0; i < system->model.light_count; i++) {
        system->model.lights[count] = system->model.lights[i];
        system->model.lights[count].copy = update->successor[system->model.lights[i].copy];
        count += system->model.lights[count].copy != GXSP_NONE;
    }
    system->model.light_count = count;
    gxsp_list_lights(system, update->scratch, update->touched);
}

/* Components. Those made of sleeping ones sleep; touched ones are woken later. */
static void gxsp_renew_components(gxsp_renewal *update) {
    gxsp_system *system = update->system;
    uint32_t *forest = (uint32_t *)gxsp_take(update->scratch, system->model.n, sizeof(uint32_t)), c, i, p;
    uint8_t *asleep = (uint8_t *)gxsp_take(update->scratch, system->model.n, 1);
    if (update->scratch->failed) return;
    for (i = 0; i < system->model.n; i++) {
        forest[i] = i;
        asleep[i] = (system->model.components[system->model.component[i]].state & GXSP_ASLEEP) != 0;
    }
    for (c = 0; c < system->mesh.chunk_count; c++)
        for (i = 0; i < system->mesh.chunks[c].node_count; i++) {
            const uint32_t slot = system->mesh.chunks[c].first_node + i;
            gxsp_join(forest, system->mesh.nodes[slot],
                      system->mesh.nodes[system->mesh.chunks[c].first_node + system->mesh.slot_root[slot]]);
        }
    gxsp_join_bent(system, forest);
    gxsp_join_followers(system, forest);
    gxsp_number_components(system, forest);
    system->model.components = (gxsp_component *)gxsp_grow(&system->pool, system->model.components, 0,
                                                           system->model.component_count, sizeof(gxsp_component));
    if (!system->pool.failed) gxsp_partials_make(system);
    if (system->pool.failed) return;
    gxsp_fill_components(system);
    for (p = 0; p < system->model.component_count; p++) system->model.components[p].state |= GXSP_ASLEEP;
    for (i = 0; i < system->model.n; i++)
        if (!system->model.fixed[i] && !asleep[i])
            system->model.components[system->model.component[i]].state &= ~GXSP_ASLEEP;
}

/* >>update: levels after an update, and the whole of it ------------------------------------------------------------ */

/* In: dirty nodes of level 1: those that touched copies follow. Out: clusters of dirty nodes, new levels below
 * the model, and numbers. Numbers of entries between other nodes are copied. */

/* Does a copy have a dirty parent? */
static int gxsp_follows_dirty(const gxsp_system *system, uint32_t copy) {
    const uint32_t *parent = system->multigrid.levels[0].parent[copy];
    int k, any = 0;
    for (k = 0; k < 4; k++) any |= parent[k] != GXSP_NONE && system->multigrid.dirty[parent[k]];
    return any;
}

/* Scratch for joining the clusters of dirty nodes */
typedef struct gxsp_clusters {
    uint32_t *forest; /* n x 4 */
    uint32_t *first;  /* by coarse node: the first slot of neighbours that follows it; valid where seen is round */
    uint32_t *seen;   /* by coarse node, 0 at first */
    uint32_t round;   /* one for each set of neighbours */
} gxsp_clusters;

/* Joins the slots of a copy with those before it in its round that follow the same dirty nodes. Has no branch on
 * whether there are any: processors could not predict it. */
static inline void gxsp_join_slots(const gxsp_renewal *update, uint32_t copy, gxsp_clusters *clusters) {
    const uint32_t *parent = update->system->multigrid.levels[0].parent[copy];
    uint32_t p;
    for (p = 0; p < 4; p++) {
        const uint32_t slot = 4 * copy + p;
        uint32_t first;
        if (parent[p] == GXSP_NONE || !update->system->multigrid.dirty[parent[p]]) continue;
        first = clusters->seen[parent[p]] == clusters->round ? clusters->first[parent[p]] : slot;
        clusters->seen[parent[p]] = clusters->round;
        clusters->first[parent[p]] = first;
        gxsp_join(clusters->forest, first, slot);
    }
}

/* Copies i and j are neighbours: they are in one cluster of each dirty node that both follow. */
static void gxsp_join_neighbours(const gxsp_renewal *update, uint32_t i, uint32_t j, gxsp_clusters *clusters) {
    clusters->round++;
    gxsp_join_slots(update, i, clusters);
    gxsp_join_slots(update, j, clusters);
}

/* The corners of each element of a chunk are neighbours. Marks the chunk as dirty if one of its nodes is. */
static void gxsp_join_chunk(const gxsp_renewal *update, gxsp_chunk *chunk, gxsp_clusters *clusters) {
    const uint32_t *copies = update->system->mesh.nodes + chunk->first_node;
    uint8_t dirty[4 * GXSP_CHUNK]; /* by node of the chunk */
    uint32_t b, i;
    int l, k;
    chunk->dirty = 0;
    for (i = 0; i < chunk->node_count; i++)
        chunk->dirty |= dirty[i] = (uint8_t)gxsp_follows_dirty(update->system, copies[i]);
    for (b = 0; b < chunk->block_count && chunk->dirty; b++)
        for (l = 0; l < GXSP_LANES; l++, clusters->round++) {
            const gxsp_corners *corner = &chunk->corners[b];
            if (!(dirty[corner->node[0][l]] | dirty[corner->node[1][l]] | dirty[corner->node[2][l]] |
                  dirty[corner->node[3][l]]))
                continue;
            for (k = 0; k < 4 && chunk->rest[b].weight[l] > 0; k++)
                if (dirty[corner->node[k][l]]) gxsp_join_slots(update, copies[corner->node[k][l]], clusters);
        }
}

/* Joins the clusters of dirty nodes anew. */
static void gxsp_join_dirty(gxsp_renewal *update, gxsp_clusters *clusters) {
    gxsp_system *system = update->system;
    const gxsp_level *fine = &system->multigrid.levels[0];
    uint32_t c, e, slot;
    for (slot = 0; slot < 4 * fine->n; slot++) clusters->forest[slot] = slot;
    for (c = 0; c < system->mesh.chunk_count; c++) gxsp_join_chunk(update, &system->mesh.chunks[c], clusters);
    for (e = 0; e < 4 * system->model.follower_count; e++)
        if (!gxsp_is_hidden(system, system->model.followers[e / 4].copy) &&
            fabs(system->model.followers[e / 4].weight[e % 4]) > 0)
            gxsp_join_neighbours(update, system->model.followers[e / 4].copy,
                                 system->model.followers[e / 4].master[e % 4], clusters);
    for (c = 0; c < system->affine.block_count; c++)
        for (e = 0; e < 6 * GXSP_LANES; e++) {
            const gxsp_affine_block *block = &system->affine.blocks[c];
            const uint32_t l = e % GXSP_LANES, i = block->vector[gxsp_edge_ends[e / GXSP_LANES][0]][l],
                           j = block->vector[gxsp_edge_ends[e / GXSP_LANES][1]][l];
            if (block->rest.weight[l] > 0) gxsp_join_neighbours(update, i, j, clusters);
        }
}

/* Splits dirty coarse nodes into clusters: the first one of each node keeps its number, others get new ones. from:
 * n x 4, room: by new node, the node that it was part of. Returns the number of nodes. */
static uint32_t gxsp_number_dirty(gxsp_renewal *update, uint32_t *forest, uint32_t *from) {
    gxsp_system *system = update->system;
    const gxsp_level *fine = &system->multigrid.levels[0];
    const uint32_t before = system->multigrid.levels[1].n;
    uint32_t slot, count = before;
    uint8_t *kept = (uint8_t *)gxsp_take(update->scratch, before, 1);
    for (slot = 0; slot < 4 * fine->n && kept; slot++) {
        uint32_t *parent = &fine->parent[slot / 4][slot % 4], root;
        if (*parent == GXSP_NONE || !system->multigrid.dirty[*parent]) continue;
        root = gxsp_root(forest, slot);
        if (root != slot)
            *parent = fine->parent[root / 4][root % 4]; /* roots come first in their tree: the root has its number
                                                           already */
        else if (kept[*parent]) {
            from[count - before] = *parent;
            *parent = count++;
        } else
            kept[*parent] = 1;
    }
    return count;
}

/* Copies that have no part in coarse levels any more have no parents. */
static void gxsp_drop_left_out(const gxsp_renewal *update) {
    gxsp_level *fine = &update->system->multigrid.levels[0];
    uint32_t i;
    if (update->system->multigrid.level_count == 0) return;
    for (i = 0; i < fine->n; i++)
        if (update->touched[i] && gxsp_is_left_out(update->system, i)) {
            memset(fine->parent[i], 0xff, sizeof fine->parent[i]);
            memset(fine->weight[i], 0, sizeof fine->weight[i]);
        }
}

/* Copies blocks of level 1's entries between nodes that are not dirty, from the level before. from, to: what elements
 * with affine copies add to them; NULL: there are none */
static void gxsp_keep_blocks(const gxsp_level *before, gxsp_level *level, const uint8_t *dirty, const double *from,
                             double *to) {
    uint32_t i, k, entry;
    for (i = 0; i < before->n; i++) {
        if (dirty[i]) continue;
        for (k = before->start[i], entry = level->start[i]; k < before->start[i + 1]; k++) {
            if (dirty[before->column[k]]) continue;
            while (level->column[entry] < before->column[k]) entry++;
            memcpy(level->block + 9 * (size_t)entry, before->block + 9 * (size_t)k, 9 * sizeof(float));
            if (from) memcpy(to + 9 * (size_t)entry, from + 9 * (size_t)k, 9 * sizeof(double));
        }
    }
}

static int gxsp_block_dirty(const gxsp_system *system, const gxsp_affine_block *block, const uint8_t *dirty) {
    int l;
    for (l = 0; l < GXSP_LANES; l++)
        if (gxsp_nested_dirty(system, block, l, dirty)) return 1;
    return 0;
}

/* Numbers of the coarse levels. Those of entries with dirty nodes come from the Hessian at the state at which the
 * others were made, so that the matrix stays semi-definite. Then the step's own pass linearises dirty chunks again. */
static int gxsp_renew_numbers(const gxsp_renewal *update, const gxsp_level *before, const double *affine,
                              const uint8_t *dirty) {
    gxsp_system *system = update->system;
    gxsp_pass pass = gxsp_pass_of(system, system->coarse.rate, system->coarse.displacement, 0);
    uint32_t c;
    int finite;
    gxsp_keep_blocks(before, &system->multigrid.levels[1], dirty, affine, system->affine.block);
    for (c = 0; c < system->mesh.chunk_count; c++)
        if (system->mesh.chunks[c].dirty) {
            const uint8_t still = system->state.chunk_still[c];
            system->state.chunk_still[c] = 0;
            gxsp_task_linearise(&pass, c);
            system->state.chunk_still[c] = still;
        }
    for (c = 0; c < system->affine.block_count; c++)
        if (gxsp_block_dirty(system, &system->affine.blocks[c], dirty))
            gxsp_affine_tangents(&pass, &system->affine.blocks[c]);
    gxsp_lend_memory(system);
    gxsp_coarse_elements(system, dirty);
    finite = affine ? gxsp_invert_diagonal(&system->multigrid.levels[1], dirty) &&
                          gxsp_nested_numbers(system, pass.rate, dirty)
                    : gxsp_lower_numbers(system, dirty);
    gxsp_return_memory(system);
    for (c = 0; c < system->mesh.chunk_count && update->linearised; c++)
        if (system->mesh.chunks[c].dirty) gxsp_task_linearise(update->linearised, c);
    return finite;
}

/* Do so many chunks follow dirty nodes that making all numbers anew, from the Hessian of the next step, costs no
 * more than making some? */
static int gxsp_most_are_dirty(const gxsp_system *system, const uint8_t *dirty) {
    uint32_t c, count = 0;
    for (c = 0; c < system->mesh.chunk_count; c++) count += system->mesh.chunks[c].dirty;
    for (c = 0; c < system->affine.block_count; c++) /* eight of these elements cost about as much as a chunk */
        count += (uint32_t)gxsp_block_dirty(system, &system->affine.blocks[c], dirty);
    return (double)count > GXSP_DIRTY * ((double)system->mesh.chunk_count + system->affine.block_count);
}

/* Have the coarse matrices served their time? */
static int gxsp_coarse_ends(const gxsp_system *system) { return system->coarse.served >= system->coarse.life; }

/* Hidden nodes, where copies are affine. Coarse nodes that had some keep them, and these are dirty as they are; others
 * get them behind all nodes. count: coarse nodes without new hidden ones; before: so far. Returns the number of nodes.
 */
static uint32_t gxsp_renew_hidden(gxsp_renewal *update, uint32_t before, uint32_t count) {
    gxsp_system *system = update->system;
    const uint32_t *hidden = system->affine.hidden, known = system->affine.hidden_count;
    uint32_t i;
    if (system->affine.count == 0) return count;
    gxsp_nested_begin(system, count);
    if (system->multigrid.pool.failed) return count;
    memcpy(system->affine.hidden, hidden, (known < before ? known : before) * sizeof *hidden);
    for (i = 0; i < before; i++)
        if (system->affine.hidden[i] != GXSP_NONE && system->multigrid.dirty[i])
            memset(system->multigrid.dirty + system->affine.hidden[i], 1, 3);
    return gxsp_nested_nodes(system, count, count);
}

/* Nodes of level 1, their places and which of them are dirty. from: see gxsp_number_dirty. */
static uint8_t *gxsp_renew_coarse_nodes(gxsp_renewal *update, const gxsp_level *before, const uint32_t *from,
                                        uint32_t count) {
    gxsp_multigrid *multigrid = &update->system->multigrid;
    const uint32_t all = gxsp_renew_hidden(update, before->n, count);
    uint8_t *dirty = (uint8_t *)gxsp_take(update->scratch, all, 1);
    uint32_t i;
    memset(&multigrid->levels[1], 0, (GXSP_LEVELS - 1) * sizeof multigrid->levels[1]);
    gxsp_level_make(&multigrid->pool, &multigrid->levels[1], all);
    if (update->scratch->failed || multigrid->pool.failed) return dirty;
    memset(dirty, 1, all);
    memcpy(dirty, multigrid->dirty, before->n);
    memcpy(multigrid->levels[1].place, before->place, before->n * sizeof *before->place);
    for (i = before->n; i < count; i++)
        memcpy(multigrid->levels[1].place[i], before->place[from[i - before->n]], sizeof *before->place);
    if (update->system->affine.count > 0) gxsp_nested_offsets(update->system);
    return dirty;
}

/* Level 1 where copies are affine: its pattern, and whether its factor is still cheap */
static void gxsp_renew_nested(gxsp_renewal *update, const gxsp_level *before, const uint8_t *dirty) {
    gxsp_system *system = update->system;
    gxsp_pairs_make(system, update->scratch);
    if (update->scratch->failed) return;
    gxsp_first_pattern(system, update->scratch, before, dirty);
    if (update->scratch->failed || system->multigrid.pool.failed) return;
    update->dear =
        system->affine.stretch <= GXSP_WIDEST && !gxsp_factors(update->scratch, &system->multigrid.levels[1],
                                                               GXSP_NESTED_SLACK * GXSP_NESTED_COST * system->model.n);
    gxsp_nested_end(system, update->scratch);
}

/* Do coarse numbers serve no longer, so that the next step makes all anew? Springs and contact are no longer known. */
static int gxsp_coarse_is_old(const gxsp_system *system) {
    return system->coarse.stiffness > 0 || system->coarse.quick || system->coarse.worn || gxsp_coarse_ends(system);
}

/* Levels below the model, with numbers if all but a few serve on */
static void gxsp_remake_levels(gxsp_renewal *update) {
    gxsp_system *system = update->system;
    gxsp_pool *scratch = update->scratch, old = system->multigrid.pool;
    gxsp_level before = system->multigrid.levels[1];
    const double *affine = system->affine.count > 0 ? system->affine.block : NULL;
    uint32_t *from = (uint32_t *)gxsp_take(scratch, 4 * system->model.n, sizeof(uint32_t));
    uint8_t *dirty = NULL;
    gxsp_clusters clusters;
    clusters.forest = (uint32_t *)gxsp_take(scratch, 4 * system->model.n, sizeof(uint32_t));
    clusters.first = (uint32_t *)gxsp_take(scratch, before.n, sizeof(uint32_t));
    clusters.seen = (uint32_t *)gxsp_take(scratch, before.n, sizeof(uint32_t));
    clusters.round = 1;
    system->multigrid.pool = gxsp_pool_make(&old.allocator);
    if (!scratch->failed) {
        gxsp_join_dirty(update, &clusters);
        dirty = gxsp_renew_coarse_nodes(update, &before, from, gxsp_number_dirty(update, clusters.forest, from));
    }
    if (!scratch->failed && !system->multigrid.pool.failed) {
        if (affine)
            gxsp_renew_nested(update, &before, dirty);
        else
            gxsp_levels_make(system, scratch, &before, dirty);
    }
    if (!scratch->failed && !system->multigrid.pool.failed) gxsp_levels_end(system);
    if (!scratch->failed && !system->multigrid.pool.failed && !system->pool.failed && system->coarse.rate >= 0 &&
        (gxsp_most_are_dirty(system, dirty) || !gxsp_renew_numbers(update, &before, affine, dirty)))
        system->coarse.rate = -1;
    gxsp_release_to(&old, NULL);
}

/* Brings levels up to date with what updates have touched. */
static void gxsp_renew_levels(gxsp_renewal *update) {
    gxsp_edges_make(update->system, update->scratch);
    if (!update->scratch->failed) gxsp_remake_levels(update);
}

/* Are there levels now that they have been made? If memory has run out, there are none. */
static int gxsp_keep_levels(gxsp_system *system, const gxsp_pool *scratch) {
    if (!scratch->failed && !system->pool.failed && !system->multigrid.pool.failed) return 1;
    gxsp_release_to(&system->multigrid.pool, NULL);
    system->multigrid.pool.failed = system->pool.failed = 0;
    system->multigrid.level_count = 0;
    system->coarse.rate = -1;
    return 0;
}

/* Makes levels, or brings them up to date, for a solve. linearised: the pass that has made the Hessian. 0: there was no
 * memory. Then there are no levels, and the next solve makes them. */
static int gxsp_fit_levels(gxsp_system *system, gxsp_pass *linearised) {
    gxsp_pool scratch = gxsp_pool_make(&system->pool.allocator);
    gxsp_renewal update;
    if (system->multigrid.level_count > 0 && system->multigrid.fits) return 1;
    memset(&update, 0, sizeof update);
    update.system = system;
    update.scratch = &scratch;
    update.linearised = linearised;
    if (system->multigrid.level_count > 0)
        gxsp_renew_levels(&update);
    else
        gxsp_make_levels(system, &scratch);
    gxsp_release_to(&scratch, NULL);
    return gxsp_keep_levels(system, &scratch);
}

/* Level 1 of affine copies with entries between the sides of the present pairs, and with none between those that were.
 * 0: there was no memory, see gxsp_fit_levels. */
static int gxsp_join_levels(gxsp_system *system) {
    gxsp_pool scratch = gxsp_pool_make(&system->pool.allocator);
    const uint64_t sides = gxsp_hash_sides(system);
    if (system->affine.count == 0 || sides == system->multigrid.joined) return 1;
    system->multigrid.joined = sides;
    gxsp_release_to(&system->multigrid.pool, system->multigrid.mark);
    gxsp_edges_make(system, &scratch);
    gxsp_pairs_make(system, &scratch);
    if (!scratch.failed) gxsp_first_pattern(system, &scratch, NULL, NULL);
    if (!scratch.failed && !system->multigrid.pool.failed) gxsp_nested_end(system, &scratch);
    if (!scratch.failed && !system->multigrid.pool.failed) gxsp_levels_end(system);
    gxsp_release_to(&scratch, NULL);
    return gxsp_keep_levels(system, &scratch);
}

/* History of steps, and data that depends on all copies */
static void gxsp_renew_steps(gxsp_renewal *update) {
    gxsp_system *system = update->system;
    size_t i;
    system->state.still_known = 0;
    system->state.base_known = 0;
    for (i = 0; i < system->model.n; i++)
        system->smoother.renewed[i] =
            update->touched[i] | (system->smoother.any_renewed ? system->smoother.renewed[i] : 0);
    system->smoother.any_renewed = 1;
    memcpy(system->state.still, system->model.fixed, system->model.n);
    gxsp_list_slots(system);
}

/* Can the model's form take changes? */
static int gxsp_is_flexible(const gxsp_system *system, const gxs_change *change) {
    return !system->multigrid.fine && !system->model.volume && !system->model.lumped_mass &&
           (system->affine.place != NULL) == (change->affine != NULL);
}

/* Are the chunks still worth keeping, and is the choice of preconditioner still right? */
static int gxsp_is_compact(gxsp_renewal *update) {
    const gxsp_system *system = update->system;
    uint32_t *count = (uint32_t *)gxsp_take(update->scratch, system->model.component_count, sizeof(uint32_t)), c;
    size_t lanes = 0;
    for (c = 0; c < system->mesh.chunk_count; c++) lanes += system->mesh.chunks[c].block_count * GXSP_LANES;
    if (lanes > system->model.element_count + system->model.element_count / 4 + 2 * GXSP_CHUNK) return 0;
    if (system->affine.block_count * GXSP_LANES > system->affine.count + system->affine.count / 4 + 2 * GXSP_CHUNK)
        return 0;
    return !count || !system->multigrid.chosen ||
           gxsp_large_component(system, count) == (system->multigrid.spacing > 0);
}

/* Applies a cut's changes to the existing chunks, and marks levels. 0: the change does not fit. Memory may also have
 * run out: see the pools. */
static int gxsp_update_system(gxsp_renewal *update) {
    gxsp_system *system = update->system;
    uint32_t *place = NULL; /* of gxsp_affine, before */
    system->leap.made = 0;
    gxsp_find_edits(update);
    gxsp_find_bent(update);
    gxsp_match_edits(update);
    if (system->affine.place) place = (uint32_t *)gxsp_take(update->scratch, update->before, sizeof *place);
    if (update->scratch->failed) return 1;
    if (place) memcpy(place, system->affine.place, update->before * sizeof *place);
    gxsp_touch_removed(update);
    gxsp_touch_followers(update);
    system->model.element_count += update->change->element_count - update->added_count;
    system->model.element_count -= update->edit_count;
    gxsp_replace_elements(update);
    if (system->pool.failed) return 1;
    if (place ? system->affine.count + update->added_count == update->bent_count : system->model.element_count == 0)
        return 0;
    if (!gxsp_renew_nodes(update) || !gxsp_renew_blocks(update)) return 0;
    gxsp_move_copies(update);
    if (update->scratch->failed || system->pool.failed) return 1;
    if (place) {
        gxsp_renew_groups(update, place);
        if (!system->pool.failed) gxsp_place_bent(update);
        if (system->pool.failed) return 1;
    }
    gxsp_renew_steps(update);
    gxsp_touch_added(update);
    gxsp_touch_groups(update);
    gxsp_recount_copies(update);
    gxsp_renew_lights(update);
    gxsp_set_followers(system, update->change->constraints, update->change->constraint_count);
    if (system->pool.failed) return 1;
    gxsp_renew_components(update);
    if (update->scratch->failed || system->pool.failed) return 1;
    gxsp_drop_left_out(update);
    system->multigrid.fits = 0;
    if (gxsp_coarse_is_old(system)) system->coarse.rate = -1;
    if (system->affine.count > 0 && system->multigrid.level_count > 0)
        gxsp_renew_levels(update); /* now, since only they tell whether their factor is still cheap */
    else
        gxsp_share_memory(system);
    return !update->dear && gxsp_is_compact(update);
}

/* >>components: translations and momentum of loose components ------------------------------------------------------ */

/* In: vectors over copies and the load. Out: the vectors without momentum, or translated so that momentum
 * balances. Uses gxsp_component.sum. */

/* Load on a copy: gravity, nodal forces and the load of damping, N; 0 if the step leaves the copy alone */
GXSP_INLINE void gxsp_load(const gxsp_problem *problem, size_t copy, double *load) {
    const gxsp_system *system = problem->system;
    const double *gravity = problem->step->gravity, *forces = problem->step->forces, *damping = system->vectors.damping;
    const double mass = system->state.still[copy] ? 0 : system->model.lumped[copy];
    load[0] = mass * gravity[0], load[1] = mass * gravity[1], load[2] = mass * gravity[2];
    if (forces && !system->state.still[copy])
        load[0] += forces[3 * copy], load[1] += forces[3 * copy + 1], load[2] += forces[3 * copy + 2];
    if (problem->damps)
        load[0] += damping[3 * copy], load[1] += damping[3 * copy + 1], load[2] += damping[3 * copy + 2];
}

/* Sums over components: cleared, then copies are added one by one, then divided by each component's mass. The mean
 * is 0 for components with any state but those ignored. */
static void gxsp_clear_components(gxsp_system *system) {
    uint32_t p;
    for (p = 0; p < system->model.component_count; p++)
        memset(system->model.components[p].sum, 0, sizeof system->model.components[p].sum);
}

static void gxsp_add_to_component(gxsp_system *system, size_t copy, double x, double y, double z) {
    double *sum = system->model.components[system->model.component[copy]].sum;
    sum[0] += x, sum[1] += y, sum[2] += z;
}

static void gxsp_average_components(gxsp_system *system, uint32_t ignored) {
    uint32_t p, r;
    for (p = 0; p < system->model.component_count; p++) {
        gxsp_component *component = &system->model.components[p];
        for (r = 0; r < 3; r++)
            component->sum[r] = component->state & ~ignored ? 0 : component->sum[r] / component->mass;
    }
}

/* Subtracts from x, component by component, the translation with x's momentum. */
static void gxsp_remove_translations(gxsp_system *system, gxsp_vector4 *x) {
    size_t i;
    int r;
    if (system->state.loose_count == 0) return;
    gxsp_clear_components(system);
    for (i = 0; i < system->model.n; i++) {
        const double m = system->model.lumped[i];
        gxsp_add_to_component(system, i, m * (double)x[i][0], m * (double)x[i][1], m * (double)x[i][2]);
    }
    gxsp_average_components(system, 0);
    for (i = 0; i < system->model.n; i++)
        for (r = 0; r < 3 && !gxsp_is_hidden(system, i); r++)
            x[i][r] -= (float)system->model.components[system->model.component[i]].sum[r];
}

/* Subtracts from x the momentum of every loose component. */
static void gxsp_remove_momentum(gxsp_system *system, double *x) {
    size_t i, r;
    if (system->state.loose_count == 0) return;
    gxsp_clear_components(system);
    for (i = 0; i < system->model.n; i++) {
        const double m = system->model.lumped[i];
        gxsp_add_to_component(system, i, m * x[3 * i], m * x[3 * i + 1], m * x[3 * i + 2]);
    }
    gxsp_average_components(system, 0);
    for (i = 0; i < system->model.n; i++)
        for (r = 0; r < 3 && !gxsp_is_hidden(system, i); r++)
            x[3 * i + r] -= system->model.components[system->model.component[i]].sum[r];
}

/* Translates every component of x that has no state but those ignored so that load = rate M (base + x - target) in
 * sum. base: n x 3, or NULL: 0 */
static void gxsp_balance_momentum(const gxsp_problem *problem, uint32_t ignored, const double *base, double *x) {
    gxsp_system *system = problem->system;
    size_t i, r;
    if ((ignored ? system->state.free_count : system->state.loose_count) == 0) return;
    gxsp_clear_components(system);
    for (i = 0; i < system->model.n; i++) {
        const double rate = problem->rate * system->model.lumped[i], *from = system->vectors.target + 3 * i;
        double f[3];
        gxsp_load(problem, i, f);
        if (gxsp_is_hidden(system, i)) memset(f, 0, sizeof f); /* a translation does no work there */
        for (r = 0; r < 3; r++) f[r] -= rate * (x[3 * i + r] + (base ? base[3 * i + r] : 0) - from[r]);
        gxsp_add_to_component(system, i, f[0], f[1], f[2]);
    }
    gxsp_average_components(system, ignored);
    for (i = 0; i < system->model.n; i++)
        for (r = 0; r < 3 && !gxsp_is_hidden(system, i); r++)
            x[3 * i + r] += system->model.components[system->model.component[i]].sum[r] / problem->rate;
}

/* Translates the direction of every component on which nothing acts now, so that its momentum balances. Linear solves
 * are single precision: their rounding loses the momentum of a component of next to no mass that contact has pushed
 * before. */
static void gxsp_balance_direction(const gxsp_problem *problem) {
    gxsp_balance_momentum(problem, GXSP_TOUCHED, problem->system->vectors.current, problem->system->vectors.direction);
}

/* Forgets which components springs and contact have acted on. */
static void gxsp_untouch_components(gxsp_system *system) {
    uint32_t p;
    for (p = 0; p < system->model.component_count; p++)
        system->model.components[p].state &= ~(GXSP_TOUCHED | GXSP_TOUCHES);
}

/* Components on which springs and contact act, by their terms, are not loose for the rest of this run of Newton's
 * method: their momentum is no longer that of the start. */
static void gxsp_touch_components(gxsp_system *system) {
    const gxsp_lasting *lasting = system->lasting;
    const gxsp_share *share = lasting->share;
    uint32_t p;
    size_t i, t;
    for (p = 0; p < system->model.component_count; p++) {
        system->model.components[p].state &= ~GXSP_TOUCHES;
        system->model.components[p].outside = system->model.components[p].paired = 0;
    }
    for (t = 0; t < lasting->count; t++)
        for (i = lasting->term[t].first; i < lasting->term[t].first + lasting->term[t].count; i++)
            if (share[i].weight * share[i].weight > 0) {
                gxsp_component *component = &system->model.components[system->model.component[share[i].copy]];
                *(lasting->term[t].spread > 0 ? &component->paired : &component->outside) = 1;
            }
    for (i = 0; i < system->lasting->share_count; i++)
        if (share[i].weight * share[i].weight > 0)
            system->model.components[system->model.component[share[i].copy]].state |= GXSP_TOUCHED | GXSP_TOUCHES;
    system->state.loose_count = system->state.free_count = 0;
    for (p = 0; p < system->model.component_count; p++) {
        system->state.loose_count += system->model.components[p].state == 0;
        system->state.free_count += (system->model.components[p].state & ~GXSP_TOUCHED) == 0;
    }
}

/* >>points: springs and contact at material points ----------------------------------------------------------------- */

/* In: the step's springs, contact points and planes. Out: their energies, forces and Hessians (terms), and which
 * components they join. */

/* A spring or contact at one point */
typedef struct gxsp_pull {
    double position[3]; /* of the point, m */
    double energy;      /* J */
    double force[3];    /* on the point, N */
    double hessian[6];  /* of the energy, N/m, packed */
    int idle;           /* a pair that is open, and was before: it has no energy, no force, no Hessian */
} gxsp_pull;

/* The span of a point: its own arrays, or the caller's */
static inline const uint32_t *gxsp_copies(const gxs_point *point) {
    return point->copies ? point->copies : point->copy;
}
static inline const double *gxsp_weights(const gxs_point *point) {
    return point->copies ? point->weights : point->weight;
}

/* Springs, contact points and pairs of a step: so they are numbered, one after the other. */
static inline size_t gxsp_point_count(const gxs_step_desc *step) {
    return step->spring_count + step->point_count + step->pair_count;
}

static inline const gxs_point *gxsp_point_of(const gxs_step_desc *step, size_t i) {
    return i < step->spring_count                     ? &step->springs[i].point
         : i < step->spring_count + step->point_count ? &step->points[i - step->spring_count]
                                                      : &step->pairs[i - step->spring_count - step->point_count].point;
}

static void gxsp_point_position(const gxs_point *point, const double *displacement, double *position) {
    const uint32_t *copies = gxsp_copies(point), *end = copies + point->count;
    const double *weight = gxsp_weights(point);
    double x = point->position[0], y = point->position[1], z = point->position[2];
    for (; copies < end; copies++, weight++) {
        const double *u = displacement + 3 * (size_t)*copies;
        x += *weight * u[0];
        y += *weight * u[1];
        z += *weight * u[2];
    }
    position[0] = x;
    position[1] = y;
    position[2] = z;
}

/* A copy of the component that the point belongs to */
static size_t gxsp_point_copy(const gxs_point *point) {
    const double *weights = gxsp_weights(point);
    uint32_t k = 0;
    while (k + 1 < point->count && !(fabs(weights[k]) > 0)) k++;
    return gxsp_copies(point)[k];
}

/* Can the step move the point? */
static int gxsp_point_moves(const gxsp_system *system, const gxs_point *point) {
    const uint32_t *copies = gxsp_copies(point);
    const double *weights = gxsp_weights(point);
    uint32_t k;
    for (k = 0; k < point->count; k++)
        if (fabs(weights[k]) > 0 && !system->state.still[copies[k]]) return 1;
    return 0;
}

static void gxsp_spring_pull(const gxs_spring *spring, const double *displacement, gxsp_pull *pull) {
    int c;
    memset(pull, 0, sizeof *pull);
    gxsp_point_position(&spring->point, displacement, pull->position);
    for (c = 0; c < 3; c++) {
        const double gap = spring->target[c] - pull->position[c];
        pull->energy += 0.5 * spring->stiffness * gap * gap;
        pull->force[c] = spring->stiffness * gap;
        pull->hessian[gxsp_packed3(c, c)] = spring->stiffness;
    }
}

/* hessian += a 1 + b n n^T */
static void gxsp_add_dyad(double a, double b, const double *n, double *hessian) {
    int i, j;
    for (i = 0; i < 3; i++)
        for (j = i; j < 3; j++) hessian[gxsp_packed3(i, j)] += (i == j ? a : 0) + b * n[i] * n[j];
}

/* Friction: energy load phi(|y|), y the way along the plane since the step's start, phi(s) = s^2 / (2 reach) up to
 * reach and s - reach/2 beyond. It is convex, so its Hessian is semi-definite. cautious: the Hessian is replaced by a
 * bound, phi'(s) / s in every direction. With the exact one, iterations jump back and forth over the kink at the end of
 * sticking. */
static void gxsp_friction_pull(const double *n, double load, double reach, const double *way, int cautious,
                               gxsp_pull *pull) {
    const double along = n[0] * way[0] + n[1] * way[1] + n[2] * way[2];
    double y[3], unit[3], s, factor;
    int c;
    for (c = 0; c < 3; c++) y[c] = way[c] - along * n[c];
    s = sqrt(y[0] * y[0] + y[1] * y[1] + y[2] * y[2]);
    factor = load / (s > reach ? s : reach);
    pull->energy += s > reach ? load * (s - 0.5 * reach) : 0.5 * factor * s * s;
    gxsp_add_dyad(factor, -factor, n, pull->hessian);
    for (c = 0; c < 3; c++) {
        pull->force[c] -= factor * y[c];
        unit[c] = s > 0 ? y[c] / s : 0;
    }
    if (s > reach && !cautious) gxsp_add_dyad(0, -factor, unit, pull->hessian);
}

/* before: where the point was at the step's start; dt: time since then */
static void gxsp_plane_pull(const gxs_plane *plane, double dt, const double *before, int cautious, gxsp_pull *pull) {
    const double *n = plane->normal, *x = pull->position,
                 depth = plane->offset - (n[0] * x[0] + n[1] * x[1] + n[2] * x[2]);
    const double pressed =
        plane->stiffness * (plane->offset - (n[0] * before[0] + n[1] * before[1] + n[2] * before[2]));
    const double reach = dt * (plane->sticking_speed > 0 ? plane->sticking_speed : 1e-3);
    double way[3];
    int c;
    if (depth > 0) {
        pull->energy += 0.5 * plane->stiffness * depth * depth;
        for (c = 0; c < 3; c++) pull->force[c] += plane->stiffness * depth * n[c];
        gxsp_add_dyad(0, plane->stiffness, n, pull->hessian);
    }
    for (c = 0; c < 3; c++) way[c] = x[c] - before[c];
    if (pressed > 0 && plane->friction > 0 && reach > 0)
        gxsp_friction_pull(n, plane->friction * pressed, reach, way, cautious, pull);
}

/* All that acts on contact point i at a displacement */
static void gxsp_contact_pull(const gxsp_problem *problem, size_t i, const double *displacement, gxsp_pull *pull) {
    const gxs_step_desc *step = problem->step;
    double before[3];
    size_t p;
    int c;
    memset(pull, 0, sizeof *pull);
    gxsp_point_position(&step->points[i], displacement, pull->position);
    gxsp_point_position(&step->points[i], problem->given, before);
    for (p = 0; p < step->plane_count; p++)
        gxsp_plane_pull(&step->planes[p], step->integrator == GXS_MIDPOINT ? 0.5 * step->dt : step->dt, before,
                        problem->shortened, pull);
    if (step->contact) {
        double force[3] = {0, 0, 0}, hessian[6] = {0, 0, 0, 0, 0, 0};
        pull->energy += step->contact(step->contact_user, i, pull->position, force, hessian);
        for (c = 0; c < 3; c++) pull->force[c] += force[c];
        for (c = 0; c < 6; c++) pull->hessian[c] += hessian[c];
    }
}

/* >>pairs: two sides in contact ------------------------------------------------------------------------------------ */

/* In: the step's pairs, and its start. Out: their energies, forces and Hessians, which are at a relative position as
 * those of springs and contact are at a position; slips and forces for the caller. Directions of pieces that only pairs
 * touch get the momentum that the pieces have together. */

/* A slip that is smaller than this share of where sliding begins sticks. */
#define GXSP_STICKS 0.5

/* Friction of the step's pairs. The loads are those of the step's start. */
static void gxsp_find_grips(const gxsp_problem *problem) {
    const gxs_step_desc *step = problem->step;
    size_t i;
    int c;
    for (i = 0; i < step->pair_count; i++) {
        const gxs_pair *pair = &step->pairs[i];
        const double speed = pair->sticking_speed > 0 ? pair->sticking_speed : 1e-3;
        gxsp_grip *grip = &problem->system->lasting->grip[i];
        double depth, elastic, slip = 0;
        gxsp_point_position(&pair->point, problem->given, grip->before);
        for (c = 0; c < 3 && (pair->flags & GXS_PAIR_OUTSIDE); c++) grip->before[c] += pair->way[c];
        depth = pair->offset - gxsp_dot(pair->normal, grip->before, 1);
        elastic = depth > 0 ? pair->friction * depth : 0;
        grip->load = pair->stiffness * elastic;
        grip->reach = elastic > step->dt * speed ? elastic : step->dt * speed;
        if (step->pair_slips) slip = gxsp_dot(step->pair_slips + 3 * i, step->pair_slips + 3 * i, 1);
        grip->sticks = slip < GXSP_STICKS * GXSP_STICKS * grip->reach * grip->reach;
    }
}

/* A pair's slip since before the step, m, at a relative position; its part along the normal is not taken off */
static void gxsp_pair_way(const gxsp_problem *problem, size_t i, const double *position, double *way) {
    const double *slips = problem->step->pair_slips, *before = problem->system->lasting->grip[i].before;
    int c;
    for (c = 0; c < 3; c++) way[c] = position[c] - before[c] + (slips ? slips[3 * i + (size_t)c] : 0);
}

static void gxsp_pair_pull(const gxsp_problem *problem, size_t i, const double *displacement, gxsp_pull *pull) {
    const gxs_pair *pair = &problem->step->pairs[i];
    const gxsp_grip *grip = &problem->system->lasting->grip[i];
    double depth;
    int c;
    memset(pull, 0, sizeof *pull);
    pull->idle = 1;
    gxsp_point_position(&pair->point, displacement, pull->position);
    depth = pair->offset - gxsp_dot(pair->normal, pull->position, 1);
    if (depth > 0) {
        pull->idle = 0;
        pull->energy = 0.5 * pair->stiffness * depth * depth;
        for (c = 0; c < 3; c++) pull->force[c] = pair->stiffness * depth * pair->normal[c];
        gxsp_add_dyad(0, pair->stiffness, pair->normal, pull->hessian);
    }
    if (grip->load > 0 && grip->reach > 0) {
        double way[3];
        pull->idle = 0;
        gxsp_pair_way(problem, i, pull->position, way);
        gxsp_friction_pull(pair->normal, grip->load, grip->reach, way, problem->shortened || grip->sticks, pull);
    }
}

/* Size of the positions whose difference is a pair's relative position times the force on it: that, in units in the
 * last place, is the rounding of its energy, J. */
static double gxsp_pair_rounding(const gxs_point *point, const double *displacement, const double *force) {
    const double *weights = gxsp_weights(point);
    double size = 0;
    uint32_t k;
    int c;
    for (k = 0; k < point->count; k++)
        for (c = 0; c < 3; c++)
            size += fabs(force[c] * weights[k] * displacement[3 * (size_t)gxsp_copies(point)[k] + (size_t)c]);
    return size;
}

/* Weights of a pair in single precision that are exactly 0 in sum, so that translations meet no stiffness: multiples of
 * a power of two. The largest one takes the rest. Hidden vectors have no part in that. */
static void gxsp_balance_shares(const gxsp_system *system, gxsp_share *share, const double *weights, uint32_t count) {
    double largest = 0, unit, sum = 0;
    uint32_t k, at = 0;
    int exponent;
    for (k = 0; k < count; k++)
        if (!gxsp_is_hidden(system, share[k].copy) && fabs(weights[k]) > largest) largest = fabs(weights[k]), at = k;
    (void)frexp(largest, &exponent);
    unit = ldexp(1, exponent > -100 ? exponent - 23 : -123);
    for (k = 0; k < count; k++) {
        const double rounded = floor(weights[k] / unit + 0.5);
        if (gxsp_is_hidden(system, share[k].copy)) continue;
        share[k].weight = (float)(rounded * unit);
        sum += rounded;
    }
    share[at].weight = (float)((double)share[at].weight - sum * unit);
}

/* Marks the components that are at work under pairs alone: island of those that lead, their mass. */
static void gxsp_find_islands(gxsp_system *system) {
    uint32_t p;
    for (p = 0; p < system->model.component_count; p++) system->model.components[p].island = 0;
    for (p = 0; p < system->model.component_count; p++) {
        const gxsp_component *component = &system->model.components[p];
        gxsp_component *lead = &system->model.components[component->lead];
        if (!(component->state & GXSP_TOUCHES)) continue;
        if ((component->state & ~(GXSP_TOUCHED | GXSP_TOUCHES)) || component->outside)
            lead->island = -1;
        else if (lead->island >= 0)
            lead->island += component->mass;
    }
}

/* The island of a copy; NULL: it is in none */
static inline gxsp_component *gxsp_island_of(gxsp_system *system, size_t copy) {
    gxsp_component *component = &system->model.components[system->model.component[copy]],
                   *lead = &system->model.components[component->lead];
    return (component->state & GXSP_TOUCHES) && lead->island > 0 ? lead : NULL;
}

/* Translates the direction of pieces that only pairs touch now, all those together that pairs join, so that their
 * momentum balances: pairs leave it alone, linear solves lose some. */
static void gxsp_balance_islands(const gxsp_problem *problem) {
    gxsp_system *system = problem->system;
    double *direction = system->vectors.direction;
    size_t i, r;
    uint32_t p;
    if (problem->step->pair_count == 0 || !(problem->rate > 0)) return;
    gxsp_find_islands(system);
    gxsp_clear_components(system);
    for (i = 0; i < system->model.n; i++) {
        gxsp_component *island = gxsp_island_of(system, i);
        double load[3];
        if (!island) continue;
        gxsp_load(problem, i, load);
        if (gxsp_is_hidden(system, i)) memset(load, 0, sizeof load); /* a translation does no work there */
        for (r = 0; r < 3; r++)
            island->sum[r] += load[r] - problem->rate * system->model.lumped[i] *
                                            (direction[3 * i + r] + system->vectors.current[3 * i + r] -
                                             system->vectors.target[3 * i + r]);
    }
    for (p = 0; p < system->model.component_count; p++)
        for (r = 0; r < 3 && system->model.components[p].island > 0; r++)
            system->model.components[p].sum[r] /= problem->rate * system->model.components[p].island;
    for (i = 0; i < system->model.n; i++) {
        const gxsp_component *island = gxsp_island_of(system, i);
        for (r = 0; r < 3 && island && !gxsp_is_hidden(system, i); r++) direction[3 * i + r] += island->sum[r];
    }
}

/* The force of every pair at the end of the step, and its slip there: as far as it stretches. Pairs that the step
 * leaves alone keep theirs. ends: displacement there; that of the start is still with the caller. */
static void gxsp_report_pairs(const gxsp_problem *problem, const double *ends) {
    const gxs_step_desc *step = problem->step;
    size_t i;
    int c;
    for (i = 0; i < step->pair_count; i++) {
        const double *n = step->pairs[i].normal;
        const gxsp_grip *grip = &problem->system->lasting->grip[i];
        gxsp_pull pull;
        double along, far, way[3];
        gxsp_pair_pull(problem, i, ends, &pull);
        if (step->pair_forces) memcpy(step->pair_forces + 3 * i, pull.force, sizeof pull.force);
        if (!step->pair_slips || !gxsp_point_moves(problem->system, &step->pairs[i].point)) continue;
        gxsp_pair_way(problem, i, pull.position, way);
        along = gxsp_dot(n, way, 1);
        for (c = 0; c < 3; c++) way[c] -= along * n[c];
        far = sqrt(gxsp_dot(way, way, 1));
        for (c = 0; c < 3; c++)
            step->pair_slips[3 * i + (size_t)c] = !(grip->load > 0) ? 0
                                                : far > grip->reach ? way[c] * (grip->reach / far)
                                                                    : way[c];
    }
}

/* >>terms: all that acts at points --------------------------------------------------------------------------------- */

/* In: springs, contact points and pairs. Out: energies of components and forces, terms of the linearisation, and which
 * components the points join. */

/* The next point of a step: springs first, then contact points, then pairs. NULL at the end. Points that do not move
 * are skipped. */
static const gxs_point *gxsp_next_pull(const gxsp_problem *problem, size_t *next, const double *displacement,
                                       gxsp_pull *pull) {
    const gxs_step_desc *step = problem->step;
    for (; *next < gxsp_point_count(step); (*next)++) {
        const size_t i = *next;
        const gxs_point *point = gxsp_point_of(step, i);
        if (!gxsp_point_moves(problem->system, point)) continue;
        if (i < step->spring_count)
            gxsp_spring_pull(&step->springs[i], displacement, pull);
        else if (i < step->spring_count + step->point_count)
            gxsp_contact_pull(problem, i - step->spring_count, displacement, pull);
        else
            gxsp_pair_pull(problem, i - step->spring_count - step->point_count, displacement, pull);
        (*next)++;
        return point;
    }
    return NULL;
}

/* The component that leads p so far */
static uint32_t gxsp_lead_root(gxsp_component *components, uint32_t p) {
    while (components[p].lead != p) {
        components[p].lead = components[components[p].lead].lead;
        p = components[p].lead;
    }
    return p;
}

/* Chooses which components lead in this step: the first of those that points join. */
static void gxsp_choose_leads(const gxsp_problem *problem) {
    const gxs_step_desc *step = problem->step;
    gxsp_component *components = problem->system->model.components;
    size_t i;
    uint32_t p, k;
    for (p = 0; p < problem->system->model.component_count; p++) components[p].lead = p;
    for (i = 0; i < gxsp_point_count(step); i++) {
        const gxs_point *point = gxsp_point_of(step, i);
        const uint32_t *copies = gxsp_copies(point);
        const double *weights = gxsp_weights(point);
        uint32_t joined = GXSP_NONE;
        for (k = 0; k < point->count; k++) {
            uint32_t first;
            if (!(fabs(weights[k]) > 0)) continue;
            p = gxsp_lead_root(components, problem->system->model.component[copies[k]]);
            joined = joined == GXSP_NONE ? p : joined;
            first = p < joined ? p : joined;
            components[p].lead = components[joined].lead = first;
            joined = first;
        }
    }
    for (p = 0; p < problem->system->model.component_count; p++) /* leads come first */
        components[p].lead = components[components[p].lead].lead;
}

/* Sums of the components' energies at the last evaluation */
static void gxsp_sum_energies(const gxsp_system *system, double *energies) {
    uint32_t p;
    int k;
    energies[0] = energies[1] = energies[2] = 0;
    for (p = 0; p < system->model.component_count; p++)
        for (k = 0; k < 3; k++) energies[k] += system->model.components[p].energies[k];
}

/* Energies of elements and points, component by component, and their forces with inertia */
static void gxsp_evaluate(const gxsp_problem *problem, const double *from, int nudge, double *force) {
    const gxs_point *point;
    gxsp_pull pull;
    size_t next = 0;
    uint32_t k;
    int c;
    gxsp_evaluate_elements(problem->system, problem->rate, from, NULL, nudge, force);
    while ((point = gxsp_next_pull(problem, &next, from, &pull)) != NULL) {
        const uint32_t *copies = gxsp_copies(point), count = point->count;
        const double *weights = gxsp_weights(point);
        double *energies;
        if (pull.idle) continue;
        energies = gxsp_lead_of(problem->system, gxsp_point_copy(point))->energies;
        energies[0] += pull.energy;
        energies[2] += fabs(pull.energy);
        for (c = 0; c < 3; c++) /* the gap of a spring is a small difference of large positions */
            energies[2] += fabs(pull.force[c]) * (fabs(point->position[c]) + fabs(pull.position[c]));
        if (next > problem->step->spring_count + problem->step->point_count)
            energies[2] += gxsp_pair_rounding(point, from, pull.force);
        for (k = 0; k < count; k++)
            for (c = 0; c < 3 && !problem->system->state.still[copies[k]]; c++)
                force[3 * (size_t)copies[k] + (size_t)c] -= weights[k] * pull.force[c];
    }
}

/* Coarse matrices are worn if springs and contact are, in all, four times stiffer or softer than when they were
 * made. */
static void gxsp_compare_terms(gxsp_system *system) {
    double sum = 0;
    size_t t;
    for (t = 0; t < system->lasting->count; t++) {
        const float *h = system->lasting->term[t].hessian;
        sum += (double)h[0] + (double)h[3] + (double)h[5];
    }
    system->state.term_stiffness = sum;
    system->coarse.worn |= sum > 4 * system->coarse.stiffness || 4 * sum < system->coarse.stiffness;
}

/* Hessians of all points at a displacement as terms, and which components they touch */
static void gxsp_terms_make(const gxsp_problem *problem, const double *displacement) {
    gxsp_lasting *lasting = problem->system->lasting;
    const gxs_point *point;
    gxsp_pull pull;
    size_t next = 0;
    uint32_t n;
    int k;
    lasting->count = lasting->share_count = 0;
    while ((point = gxsp_next_pull(problem, &next, displacement, &pull)) != NULL) {
        gxsp_term *term = &lasting->term[lasting->count];
        if (!(pull.hessian[0] + pull.hessian[3] + pull.hessian[5] > 0) && !(gxsp_dot(pull.force, pull.force, 1) > 0))
            continue;
        lasting->count++;
        term->first = lasting->share_count;
        term->count = point->count;
        term->assembled = 0;
        term->spread = 0;
        for (n = 0; n < point->count; n++) {
            gxsp_share *share = &lasting->share[lasting->share_count++];
            share->copy = gxsp_copies(point)[n];
            share->weight = (float)gxsp_weights(point)[n];
        }
        if (next > problem->step->spring_count + problem->step->point_count &&
            !(problem->step->pairs[next - 1 - problem->step->spring_count - problem->step->point_count].flags &
              GXS_PAIR_OUTSIDE)) {
            gxsp_balance_shares(problem->system, lasting->share + term->first, gxsp_weights(point), point->count);
            for (n = 0; n < point->count; n++) term->spread += fabsf(lasting->share[term->first + n].weight);
        }
        for (k = 0; k < 6; k++) term->hessian[k] = (float)(problem->system->model.scale * pull.hessian[k]);
    }
    gxsp_touch_components(problem->system);
    gxsp_compare_terms(problem->system);
}

/* >>cg: conjugate gradients ---------------------------------------------------------------------------------------- */

/* In: the last linearisation and the residual, which is used up. Out: the direction, and for each component what
 * the solve has left. */

/* The two measures of a vector r of forces, squared: r . D^-1 r (energy) and |D^-1 r|^2 (displacement) */
typedef struct gxsp_norms {
    double energy, displacement;
    double rest; /* displacement of what is not affine */
} gxsp_norms;

/* What the last iterations gained: half of it is the energy that the error has lost. Where copies are affine, this says
 * more than the residual, in which the stiff stretch of a sheet hides how far it still has to bend. */
typedef struct gxsp_gains {
    double gain[2 * GXSP_GAINS], total; /* gain: the last ones in turn; total: of the guess and of all of them */
    uint32_t count;
} gxsp_gains;

static void gxsp_note_gain(gxsp_gains *gains, double gain) {
    gains->gain[gains->count++ % (2 * GXSP_GAINS)] = gain;
    gains->total += gain;
}

/* Is the error's share of the energy below goal? The squared error of GXSP_GAINS iterations ago is what they gained and
 * what is still to be gained, of which the iterations before them tell the rate (Hestenes and Stiefel, 1952; Strakos
 * and Tichy, 2002). */
static int gxsp_has_gained(const gxsp_gains *gains, double goal) {
    double last = 0, before = 0, rest = 1;
    uint32_t k;
    if (gains->count < GXSP_GAINS) return 0;
    for (k = 1; k <= GXSP_GAINS; k++) last += gains->gain[(gains->count - k) % (2 * GXSP_GAINS)];
    for (k = GXSP_GAINS + 1; k <= 2 * GXSP_GAINS && k <= gains->count; k++)
        before += gains->gain[(gains->count - k) % (2 * GXSP_GAINS)];
    if (before > 0) rest = 1 - last / before > 0.05 ? 1 - last / before : 0.05;
    return last <= goal * rest * gains->total;
}

static int gxsp_converged(const gxsp_norms *now, const gxsp_norms *first, double goal) {
    return now->energy <= goal * first->energy && now->displacement <= goal * first->displacement;
}

/* scaled = D^-1 r, times the step length of the smoother, of copies first ... end - 1. sums: r . D^-1 r, |D^-1 r|^2 */
static void gxsp_scale_copies(const gxsp_system *system, const double *r, size_t first, size_t end, double *sums) {
    const double factor = system->multigrid.used && !system->multigrid.fine ? (double)system->smoother.omega : 1;
    double energy = 0, displacement = 0;
    size_t i;
    for (i = first; i < end; i++) {
        const float *d = system->vectors.diagonal + 6 * i;
        const double a = r[3 * i], b = r[3 * i + 1], c = r[3 * i + 2];
        const double x = (double)d[0] * a + (double)d[1] * b + (double)d[2] * c,
                     y = (double)d[1] * a + (double)d[3] * b + (double)d[4] * c,
                     z = (double)d[2] * a + (double)d[4] * b + (double)d[5] * c;
        if (gxsp_is_grouped(system, i)) continue; /* see gxsp_scale_groups */
        energy += x * a + y * b + z * c;
        displacement += x * x + y * y + z * z;
        system->vectors.scaled[i][0] = (float)(factor * x), system->vectors.scaled[i][1] = (float)(factor * y),
        system->vectors.scaled[i][2] = (float)(factor * z);
    }
    sums[0] = energy;
    sums[1] = displacement;
}

static void gxsp_task_scale(void *context, size_t index) {
    const gxsp_pass *pass = (const gxsp_pass *)context;
    size_t first, end = gxsp_range(pass->system, index, &first);
    gxsp_scale_copies(pass->system, pass->from, first, end, pass->system->vectors.range_sum[index]);
}

/* As gxsp_scale_copies, for the groups of affine copies, by their 12x12 blocks. Adds to sums. */
static void gxsp_scale_groups(const gxsp_system *system, const double *r, double *sums) {
    const double factor = system->multigrid.used ? (double)system->smoother.omega : 1;
    uint32_t group;
    int k;
    for (group = 0; group < system->affine.group_count; group++) {
        const uint32_t *member = system->affine.member[group];
        double x[12], z[12];
        for (k = 0; k < 12; k++) x[k] = r[3 * (size_t)member[k / 3] + (size_t)(k % 3)];
        gxsp_affine_apply(&system->affine, group, x, z);
        for (k = 0; k < 12; k++) {
            sums[0] += x[k] * z[k];
            sums[1] += z[k] * z[k];
            system->vectors.scaled[member[k / 3]][k % 3] = (float)(factor * z[k]);
        }
    }
}

/* Norms over all ranges, by a task that scales r */
static gxsp_norms gxsp_norms_of(gxsp_system *system, void (*task)(void *, size_t), gxsp_pass *pass, const double *r) {
    gxsp_norms norms;
    double sums[2];
    gxsp_over_ranges(system, task, pass, sums, 2);
    norms.rest = sums[1];
    gxsp_scale_groups(system, r, sums);
    norms.energy = sums[0], norms.displacement = sums[1];
    return norms;
}

static gxsp_norms gxsp_scale(gxsp_system *system, const double *r) {
    gxsp_pass pass;
    memset(&pass, 0, sizeof pass);
    pass.from = r;
    return gxsp_norms_of(system, gxsp_task_scale, &pass, r);
}

/* direction += factor x, residual -= factor y; then scales the residual. */
static void gxsp_task_advance(void *context, size_t index) {
    const gxsp_pass *pass = (const gxsp_pass *)context;
    const gxsp_system *system = pass->system;
    size_t i, first, end = gxsp_range(system, index, &first), c;
    for (i = first; i < end; i++)
        for (c = 0; c < 3; c++) {
            system->vectors.direction[3 * i + c] += pass->factor * (double)pass->x[i][c];
            system->vectors.residual[3 * i + c] -= pass->factor * (double)pass->y[i][c];
        }
    gxsp_scale_copies(system, system->vectors.residual, first, end, system->vectors.range_sum[index]);
}

/* Advances the direction by length x, and the residual by as much of y = A x. Returns the norms of the new residual. */
static gxsp_norms gxsp_advance(gxsp_system *system, double length, gxsp_vector4 *x, gxsp_vector4 *y) {
    gxsp_pass pass;
    memset(&pass, 0, sizeof pass);
    pass.factor = length;
    pass.x = x;
    pass.y = y;
    return gxsp_norms_of(system, gxsp_task_advance, &pass, system->vectors.residual);
}

/* Sums: residual . x, and x . y if there is a y */
static void gxsp_task_work(void *context, size_t index) {
    const gxsp_pass *pass = (const gxsp_pass *)context;
    const gxsp_system *system = pass->system;
    size_t i, end = gxsp_range(system, index, &i), c;
    double *sums = system->vectors.range_sum[index];
    sums[0] = sums[1] = 0;
    for (; i < end; i++)
        for (c = 0; c < 3; c++) {
            sums[0] += system->vectors.residual[3 * i + c] * (double)pass->x[i][c];
            sums[1] += pass->y ? (double)pass->x[i][c] * (double)pass->y[i][c] : 0;
        }
}

/* z = M^-1 r from D^-1 r, both in scaled, without translations of loose components. energy: r . D^-1 r. Returns r .
 * z. */
static double gxsp_precondition(gxsp_system *system, double rate, double energy) {
    gxsp_pass pass;
    double sums[2];
    size_t i;
    int c;
    if (system->multigrid.used) gxsp_v_cycle(system, rate, energy);
    for (i = 0; i < system->model.n && system->model.volume; i++)
        for (c = 0; c < 3; c++)
            system->vectors.scaled[i][c] =
                system->state.still[i] ? 0
                                       : system->model.volume[i] * (float)system->vectors.residual[3 * i + (size_t)c];
    gxsp_extend(system, system->vectors.scaled);
    gxsp_remove_translations(system, system->vectors.scaled);
    memset(&pass, 0, sizeof pass);
    pass.x = system->vectors.scaled;
    gxsp_over_ranges(system, gxsp_task_work, &pass, sums, 1);
    return sums[0];
}

/* Can r . z be that of a definite preconditioner? energy: r . D^-1 r; single precision allows 1e7 times as much at
 * most */
static int gxsp_is_definite(double rho, double energy) {
    return gxsp_finite(rho) && rho > 0 && rho <= GXSP_ABSURD * energy;
}

/* As gxsp_precondition, but definite: if the cycle proves indefinite, the smoother's step length is shortened, and at
 * worst the cycle is left out of this solve. now: measures of the residual; changed: the preconditioner differs from
 * the one before */
static double gxsp_precondition_definite(gxsp_system *system, double rate, const gxsp_norms *now, int *changed) {
    const float omega = system->smoother.omega;
    double rho = gxsp_precondition(system, rate, now->energy);
    if (!gxsp_is_definite(rho, now->energy) && system->multigrid.used && !system->multigrid.fine &&
        system->smoother.cautious == 0) {
        gxsp_shorten_omega(system, 0);
        (void)gxsp_scale(system, system->vectors.residual);
        rho = gxsp_precondition(system, rate, now->energy);
    }
    *changed = omega < system->smoother.omega || omega > system->smoother.omega;
    if (!gxsp_is_definite(rho, now->energy) && system->multigrid.used) {
        system->multigrid.used = 0;
        system->coarse.worn = *changed = 1;
        (void)gxsp_scale(system, system->vectors.residual);
        rho = gxsp_precondition(system, rate, now->energy);
    }
    return rho;
}

static double gxsp_now(const gxsp_problem *problem) {
    return problem->step->clock ? problem->step->clock(problem->step->clock_user) : 0;
}

static int gxsp_out_of_time(gxsp_problem *problem) {
    if (problem->step->budget_seconds > 0 && problem->step->clock &&
        gxsp_now(problem) - problem->start > problem->step->budget_seconds)
        problem->report.stop = GXS_STOP_SECONDS;
    return problem->report.stop == GXS_STOP_SECONDS;
}

/* Makes a guess 0 on copies that are still now, and applies the Hessian to it. Returns its curvature. work: with
 * the residual; cross: of the product with the other guess, if there is one */
static double gxsp_weigh_guess(gxsp_system *system, double rate, gxsp_vector4 *guess, gxsp_vector4 *other,
                               gxsp_vector4 *product, double *work, double *cross) {
    gxsp_pass pass;
    double sums[2], curvature;
    size_t i;
    for (i = 0; i < system->model.n; i++)
        if (system->state.still[i]) memset(guess[i], 0, sizeof *guess);
    gxsp_extend(system, guess);
    gxsp_remove_translations(system, guess);
    curvature = gxsp_product(system, rate, guess, product);
    memset(&pass, 0, sizeof pass);
    pass.x = guess;
    gxsp_over_ranges(system, gxsp_task_work, &pass, sums, 1);
    *work = sums[0];
    if (other) {
        pass.x = other;
        pass.y = product;
        gxsp_over_ranges(system, gxsp_task_work, &pass, sums, 2);
        *cross = sums[1];
    }
    return curvature;
}

/* Starts conjugate gradients at the best point of the plane of the last two steps' first directions. Where the
 * acceleration changes little from step to step, that is most of the solution. now: norms of the residual; returns
 * those of the new one. gains: what the guess gained */
static gxsp_norms gxsp_guess_direction(gxsp_system *system, double rate, gxsp_norms now, gxsp_gains *gains) {
    gxsp_vector4 *product = system->vectors.search;
    double curvature, work, further = 0, first, cross = 0, second = 0;
    curvature = gxsp_weigh_guess(system, rate, system->vectors.guess[0], NULL, product, &work, NULL);
    first = work / curvature;
    if (!(curvature > 0) || !gxsp_finite(work) || !gxsp_finite(curvature) || !gxsp_finite(first)) return now;
    if (system->state.guess_count > 1) {
        double own = gxsp_weigh_guess(system, rate, system->vectors.guess[1], system->vectors.guess[0],
                                      system->vectors.product, &further, &cross);
        const double share = cross / curvature, rest = own - share * cross;
        second = (further - share * work) / rest;
        if (!(rest > GXSP_PARALLEL * own) || !gxsp_finite(own) || !gxsp_finite(share) || !gxsp_finite(second))
            second = 0;
        first -= second > 0 || second < 0 ? second * share : 0;
    }
    gains->total = first * work + (second > 0 || second < 0 ? second * further : 0);
    now = gxsp_advance(system, first, system->vectors.guess[0], product);
    if (second > 0 || second < 0) now = gxsp_advance(system, second, system->vectors.guess[1], system->vectors.product);
    return now;
}

/* The direction found becomes the next step's first guess, the one before its second. */
static void gxsp_keep_guess(gxsp_system *system) {
    gxsp_vector4 *oldest = system->vectors.guess[1];
    size_t i;
    system->vectors.guess[1] = system->vectors.guess[0];
    system->vectors.guess[0] = oldest;
    for (i = 0; i < 3 * system->model.n; i++) oldest[i / 3][i % 3] = (float)system->vectors.direction[i];
    system->state.guess_count += system->state.guess_count < 2;
}

/* search = scaled + factor search */
static void gxsp_task_search(void *context, size_t index) {
    const gxsp_pass *pass = (const gxsp_pass *)context;
    const gxsp_system *system = pass->system;
    const float factor = (float)pass->factor;
    size_t i, end = gxsp_range(system, index, &i), c;
    for (; i < end; i++)
        for (c = 0; c < 4; c++)
            system->vectors.search[i][c] = system->vectors.scaled[i][c] + factor * system->vectors.search[i][c];
}

/* For each component, the work of the remaining residual along the direction */
static void gxsp_note_left(gxsp_system *system) {
    size_t i;
    uint32_t p;
    for (p = 0; p < system->model.component_count; p++) system->model.components[p].left = 0;
    for (i = 0; i < system->model.n; i++)
        gxsp_lead_of(system, i)->left +=
            gxsp_dot(system->vectors.residual + 3 * i, system->vectors.direction + 3 * i, 1) / system->model.scale;
}

/* Solves scale (K + rate M) direction = scale residual to a share of the residual, which is used up. Directions of
 * free components carry no momentum: their translations are projected out of the preconditioned residual (deflated
 * conjugate gradients; the residual has none, see gxsp_start). Operator and preconditioner are single precision,
 * vectors and sums double. 0: a number overflowed. */
static int gxsp_conjugate_gradients(gxsp_problem *problem) {
    gxsp_system *system = problem->system;
    const double goal = problem->cg_tolerance * problem->cg_tolerance, rate = problem->rate;
    const int start = problem->report.newton_iterations == 0;
    gxsp_norms first, now, guessed;
    gxsp_gains gains;
    gxsp_pass pass;
    uint32_t iteration;
    int changed;
    double rho = 0;
    size_t i;
    problem->indefinite = 0;
    memset(&gains, 0, sizeof gains);
    for (i = 0; i < 3 * system->model.n; i++) system->vectors.residual[i] *= system->model.scale;
    now = first = gxsp_scale(system, system->vectors.residual);
    memset(system->vectors.direction, 0, 3 * system->model.n * sizeof(double));
    if (start && system->state.guess_count > 0) now = gxsp_guess_direction(system, rate, now, &gains);
    guessed = now;
    if (!gxsp_converged(&now, &first, goal)) rho = gxsp_precondition_definite(system, rate, &now, &changed);
    memcpy(system->vectors.search, system->vectors.scaled, system->model.n * sizeof *system->vectors.search);
    memset(&pass, 0, sizeof pass);
    for (iteration = 0; iteration < problem->cg_iterations && !gxsp_converged(&now, &first, goal); iteration++) {
        const double curvature = gxsp_product(system, rate, system->vectors.search, system->vectors.product),
                     before = rho;
        if (!gxsp_finite(curvature) || !gxsp_finite(rho)) return 0;
        if (curvature <= 0 || rho <= 0) { /* with a projected Hessian: only rounding is left */
            problem->indefinite = 1;
            break;
        }
        now = gxsp_advance(system, rho / curvature, system->vectors.search, system->vectors.product);
        problem->report.cg_iterations++;
        gxsp_note_gain(&gains, rho * rho / curvature);
        if (system->affine.count > 0 && system->multigrid.used && now.rest <= goal * first.displacement &&
            gxsp_has_gained(&gains, goal))
            break;
        if (iteration + 1 == problem->cg_iterations || gxsp_converged(&now, &first, goal) || gxsp_out_of_time(problem))
            break;
        rho = gxsp_precondition_definite(system, rate, &now, &changed);
        pass.factor = changed ? 0 : rho / before;
        gxsp_over_ranges(system, gxsp_task_search, &pass, NULL, 0);
    }
    problem->nepers = now.energy > 0 && guessed.energy > now.energy ? 0.5 * log(guessed.energy / now.energy) : 0;
    gxsp_note_left(system);
    gxsp_follow(system, NULL, system->vectors.direction);
    gxsp_balance_direction(problem);
    gxsp_balance_islands(problem);
    if (gxsp_first_not_finite(system->vectors.direction, 3 * system->model.n) < 3 * system->model.n) return 0;
    if (start) gxsp_keep_guess(system);
    return 1;
}

/* >>ageing: when coarse matrices are made anew --------------------------------------------------------------------- */

/* In: the linearisation, counts of iterations. Out: matrices and preconditioner ready for a solve, and the solve
 * itself. Writes gxsp_coarse. */

/* Is multigrid faster at this rate? It is used where the caller asked for it, and where inertia has a small mean share
 * of the diagonal blocks of some large component. Each copy's share counts as 4/3 of the bound at most, so that a
 * quarter of stiff copies is enough. */
static int gxsp_coarse_pays(gxsp_system *system, double rate) {
    const double bounds[2] = {3 * GXSP_INERTIA / (system->model.scale * rate),
                              3 * GXSP_INERTIA_PAIRED / (system->model.scale * rate)}; /* with pairs */
    size_t i;
    uint32_t p;
    if (!system->multigrid.chosen || !(rate > 0)) return 1;
    gxsp_clear_components(system);
    for (i = 0; i < system->model.n; i++) {
        gxsp_component *component = &system->model.components[system->model.component[i]];
        double *sum = component->sum; /* share, copies */
        const float *d = system->vectors.diagonal + 6 * i;
        const double compliance = (double)d[0] + (double)d[3] + (double)d[5],
                     share = gxsp_is_hidden(system, i) ? 0 : system->model.lumped[i] * compliance,
                     bound = bounds[component->paired];
        if (system->state.still[i] || !(compliance > 0)) continue;
        sum[0] += share < 4 * bound / 3 ? share : 4 * bound / 3;
        sum[1] += 1;
    }
    for (p = 0; p < system->model.component_count; p++)
        if (system->model.components[p].sum[1] >= gxsp_large(system) &&
            system->model.components[p].sum[0] <=
                bounds[system->model.components[p].paired] * system->model.components[p].sum[1])
            return 1;
    return 0;
}

/* Are the coarse matrices of other steps than this one? */
static int gxsp_coarse_differs(const gxsp_problem *problem) {
    const gxsp_system *system = problem->system;
    return system->coarse.rate < problem->rate || system->coarse.rate > problem->rate;
}

/* The levels for a solve. 0: there was no memory. */
static int gxsp_prepare_levels(gxsp_problem *problem) {
    gxsp_system *system = problem->system;
    gxsp_pass linearised = gxsp_pass_of(system, problem->rate, system->vectors.current, problem->exact);
    if (gxsp_coarse_differs(problem)) system->coarse.rate = -1; /* none of their numbers serves on */
    problem->starved |= !gxsp_fit_levels(system, &linearised);
    system->multigrid.used = system->multigrid.level_count > 0;
    return !problem->starved;
}

/* Updates matrix and preconditioner to the linearisation. Coarse matrices are made anew if there are none, if the
 * rate has changed, if iterations have doubled since they were made, or at the end of their life: before the further
 * iterations cost more than new matrices. */
static int gxsp_prepare(gxsp_problem *problem) {
    gxsp_system *system = problem->system;
    int other; /* the rate differs from that of the coarse matrices */
    if (system->multigrid.fine) {
        gxsp_assemble(system, system->model.scale * problem->rate);
        if (!gxsp_invert_fine(system)) return 0;
    }
    system->multigrid.used =
        system->multigrid.spacing > 0 && (system->state.quick || gxsp_coarse_pays(system, problem->rate));
    if (system->multigrid.used && !gxsp_prepare_levels(problem)) return 0;
    if (!system->multigrid.used) return 1;
    if (!system->multigrid.fine) gxsp_choose_omega(system, problem->rate);
    other = gxsp_coarse_differs(problem);
    if (!other && (problem->exact || !(system->coarse.worn || gxsp_coarse_ends(system)))) return 1;
    if (!gxsp_join_levels(system)) {
        problem->starved = 1;
        return 0;
    }
    system->coarse.lived = system->coarse.served;
    system->coarse.pace_old = other ? 0 : system->coarse.pace;
    system->coarse.pace = system->coarse.read_nepers = 0;
    system->coarse.read = system->coarse.served = 0;
    system->coarse.rate = problem->rate;
    system->coarse.quick = system->state.quick;
    memcpy(system->coarse.displacement, system->vectors.current, 3 * system->model.n * sizeof(double));
    system->coarse.worn = 0;
    system->coarse.stiffness = system->state.term_stiffness;
    return gxsp_coarse_numbers(system, problem->rate);
}

/* Chooses how long the coarse matrices are to serve. Their first reading tells how much slower the ones before were
 * in the end. If the share lost has grown evenly to that, the life that minimises cost / life + share / lived x life /
 * 2 is best. */
static void gxsp_learn_life(gxsp_system *system) {
    const double share = system->coarse.pace_old / system->coarse.pace - 1, lived = system->coarse.lived;
    const double best = share > GXSP_AGEING ? sqrt(2 * GXSP_REMAKE * lived / share) : GXSP_PATIENCE * lived;
    system->coarse.life = best < 1e9 ? (uint32_t)best + 1 : 1000000000;
}

/* Takes a reading when it is due. */
static void gxsp_read_pace(gxsp_system *system) {
    const int first = !(system->coarse.pace > 0);
    if (system->coarse.read < GXSP_READING || !(system->coarse.read_nepers > 0)) return;
    system->coarse.pace = system->coarse.read / system->coarse.read_nepers;
    system->coarse.read = 0;
    system->coarse.read_nepers = 0;
    if (first) system->coarse.pace_young = system->coarse.pace;
    if (first && system->coarse.pace_old > 0) gxsp_learn_life(system);
    system->coarse.worn |= system->coarse.pace > GXSP_WORN * system->coarse.pace_young;
}

/* Solves the linear system, and learns from the iterations how the coarse matrices age. */
static int gxsp_solve(gxsp_problem *problem) {
    gxsp_system *system = problem->system;
    uint32_t before = problem->report.cg_iterations, count;
    double start = gxsp_now(problem), prepared;
    int solved = gxsp_prepare(problem);
    prepared = gxsp_now(problem);
    solved = solved && gxsp_conjugate_gradients(problem);
    problem->report.seconds_prepare += prepared - start;
    problem->report.seconds_solve += gxsp_now(problem) - prepared;
    count = problem->report.cg_iterations - before;
    problem->report.preconditioner = system->multigrid.used ? GXS_MULTIGRID
                                   : system->model.volume   ? GXS_VOLUME_RATIO
                                                            : GXS_BLOCK_JACOBI;
    if (!system->multigrid.used) return solved;
    system->coarse.served += count;
    system->coarse.read += count;
    system->coarse.read_nepers += count > 0 ? problem->nepers : 0;
    gxsp_read_pace(system);
    return solved;
}

/* >>sleep: components at rest are left out ------------------------------------------------------------------------- */

/* In: the step, the state that the caller gives, rest times. Out: which components sleep. A component that has
 * been slow for long sleeps until something touches it: loads, targets, springs, contact points or planes that
 * change, or a state or rest time that the caller has written. */

/* Hashes of nodal forces and contact points, in all and by component. Copies without a force do not count. */
static uint64_t gxsp_hash_forces(gxsp_system *system, const gxs_step_desc *step) {
    static const double zero[3] = {0, 0, 0};
    uint64_t all = 1;
    uint32_t p, k;
    size_t i;
    for (p = 0; p < system->model.component_count; p++) system->model.components[p].forces[1] = 1;
    for (i = 0; step->forces && i < system->model.n; i++)
        if (gxsp_differs(step->forces + 3 * i, zero)) {
            uint64_t *hash = &system->model.components[system->model.component[i]].forces[1];
            const double index = (double)i;
            *hash = gxsp_hash(gxsp_hash(*hash, &index, 1), step->forces + 3 * i, 3);
            all = gxsp_hash(gxsp_hash(all, &index, 1), step->forces + 3 * i, 3);
        }
    for (i = 0; i < step->point_count && step->sleep_speed > 0; i++) {
        const gxs_point *point = &step->points[i];
        for (k = 0; k < point->count; k++) {
            const uint32_t copy = gxsp_copies(point)[k];
            const double values[2] = {(double)copy, gxsp_weights(point)[k]};
            uint64_t *hash = &system->model.components[system->model.component[copy]].forces[1];
            if (!(fabs(values[1]) > 0)) continue;
            *hash = gxsp_hash(gxsp_hash(*hash, values, 2), point->position, 3);
            all = gxsp_hash(gxsp_hash(all, values, 2), point->position, 3);
        }
    }
    return all;
}

static gxs_scene gxsp_scene_make(gxsp_system *system, const gxs_step_desc *step) {
    gxs_scene scene;
    size_t i;
    uint32_t k;
    memcpy(scene.gravity, step->gravity, sizeof scene.gravity);
    scene.planes = 1;
    for (i = 0; i < step->plane_count; i++) {
        const gxs_plane *plane = &step->planes[i];
        const double values[4] = {plane->offset, plane->stiffness, plane->friction, plane->sticking_speed};
        scene.planes = gxsp_hash(gxsp_hash(scene.planes, plane->normal, 3), values, 4);
    }
    scene.forces = gxsp_hash_forces(system, step);
    scene.springs = 1;
    for (i = 0; i < system->model.component_count; i++) system->model.components[i].has_spring[1] = 0;
    for (i = 0; i < step->spring_count; i++) {
        const gxs_spring *spring = &step->springs[i];
        for (k = 0; k < spring->point.count; k++) {
            const uint32_t copy = gxsp_copies(&spring->point)[k];
            const double values[3] = {(double)copy, gxsp_weights(&spring->point)[k], spring->stiffness};
            scene.springs =
                gxsp_hash(gxsp_hash(gxsp_hash(scene.springs, spring->target, 3), spring->point.position, 3), values, 3);
            if (fabs(values[1]) > 0) system->model.components[system->model.component[copy]].has_spring[1] = 1;
        }
    }
    return scene;
}

/* Notes which components pairs join to something. Which pairs there are may change from step to step as a search finds
 * them, so they are in no hash. */
static void gxsp_note_pairs(gxsp_system *system, const gxs_step_desc *step) {
    uint32_t k;
    size_t i;
    for (i = 0; i < system->model.component_count; i++) system->model.components[i].has_pair[1] = 0;
    for (i = 0; i < step->pair_count; i++)
        for (k = 0; k < step->pairs[i].point.count; k++)
            if (fabs(gxsp_weights(&step->pairs[i].point)[k]) > 0)
                system->model.components[system->model.component[gxsp_copies(&step->pairs[i].point)[k]]].has_pair[1] =
                    1;
}

/* Does the state of a copy differ from the one that the last step returned? Of velocities only those of sleepers
 * are known: 0. */
static int gxsp_is_written(const gxsp_system *system, size_t copy, const double *displacement, const double *velocity) {
    static const double zero[3] = {0, 0, 0};
    if (system->model.fixed[copy]) return 0;
    return ((system->model.components[system->model.component[copy]].state & GXSP_ASLEEP) &&
            gxsp_differs(velocity, zero)) ||
           (system->state.stepped && gxsp_differs(displacement, system->vectors.current + 3 * copy));
}

/* Wakes the components that a pair joins to something outside that has moved. */
static void gxsp_wake_paired(gxsp_system *system, const gxs_pair *pair) {
    uint32_t k;
    for (k = 0; k < pair->point.count && (pair->flags & GXS_PAIR_WAKES); k++)
        if (fabs(gxsp_weights(&pair->point)[k]) > 0)
            system->model.components[system->model.component[gxsp_copies(&pair->point)[k]]].woken = 1;
}

/* Wakes the components that a change touches. */
static void gxsp_wake_touched(gxsp_problem *problem, const double *displacement, const double *velocity) {
    gxsp_system *system = problem->system;
    const gxs_step_desc *step = problem->step;
    const gxs_scene *before = &system->lasting->scene, *now = &problem->scene;
    const int springs = now->springs != before->springs, forces = now->forces != before->forces,
              known = system->state.still_known;
    const int all =
        gxsp_differs(now->gravity, before->gravity) || now->planes != before->planes || (!known && (springs || forces));
    size_t i;
    uint32_t p;
    for (p = 0; p < system->model.component_count; p++) {
        gxsp_component *component = &system->model.components[p];
        component->woken = (system->state.failed && component->woken) || all ||
                           (forces && component->forces[0] != component->forces[1]) ||
                           (springs && (component->has_spring[0] || component->has_spring[1])) ||
                           component->has_pair[0] > component->has_pair[1];
    }
    for (i = 0; i < step->pair_count; i++) gxsp_wake_paired(system, &step->pairs[i]);
    for (i = 0; i < system->model.n; i++) {
        gxsp_component *component = &system->model.components[system->model.component[i]];
        if (step->targets && system->model.held[i] && gxsp_differs(step->targets + 3 * i, displacement + 3 * i))
            component->woken = 1;
        if (step->sleep_speed > 0 && gxsp_is_written(system, i, displacement + 3 * i, velocity + 3 * i))
            component->woken = 1;
    }
}

/* Is a copy too fast to sleep? velocity: its own */
static int gxsp_too_fast(const gxs_step_desc *step, const double *velocity) {
    return gxsp_dot(velocity, velocity, 1) > step->sleep_speed * step->sleep_speed;
}

/* Wakes the components that springs and contact points join to awake ones. Returns whether there were any. */
static int gxsp_wake_joined(gxsp_system *system, const gxs_step_desc *step) {
    int any = 0;
    uint32_t k;
    size_t i;
    for (i = 0; i < gxsp_point_count(step); i++) {
        const gxs_point *point = gxsp_point_of(step, i);
        const uint32_t *copies = gxsp_copies(point);
        const double *weights = gxsp_weights(point);
        int awake = 0;
        for (k = 0; k < point->count; k++)
            awake |= fabs(weights[k]) > 0 && !system->model.fixed[copies[k]] &&
                     !system->model.components[system->model.component[copies[k]]].resting;
        for (k = 0; k < point->count && awake; k++) {
            gxsp_component *component = &system->model.components[system->model.component[copies[k]]];
            any |= fabs(weights[k]) > 0 && component->resting;
            component->resting &= !(fabs(weights[k]) > 0);
        }
    }
    return any;
}

/* Chooses the components that sleep in this step, and so the copies that are still. */
static void gxsp_choose_sleepers(gxsp_problem *problem, const double *displacement, const double *velocity) {
    gxsp_system *system = problem->system;
    const gxs_step_desc *step = problem->step;
    const double time = step->sleep_time > 0 ? step->sleep_time : 0.5;
    int changed = 0;
    uint32_t p;
    size_t i;
    problem->scene = gxsp_scene_make(system, step);
    gxsp_note_pairs(system, step);
    gxsp_wake_touched(problem, displacement, velocity);
    for (p = 0; p < system->model.component_count; p++)
        system->model.components[p].resting = step->sleep_speed > 0 && !system->model.components[p].woken;
    for (i = 0; i < system->model.n && step->sleep_speed > 0; i++)
        if (!system->model.fixed[i] && (step->rest_times[i] < time || gxsp_too_fast(step, velocity + 3 * i)))
            system->model.components[system->model.component[i]].resting = 0;
    while (step->sleep_speed > 0 && gxsp_wake_joined(system, step)) {}
    for (p = 0; p < system->model.component_count; p++) {
        gxsp_component *component = &system->model.components[p];
        const uint32_t state = (component->state & ~GXSP_ASLEEP) | (component->resting ? GXSP_ASLEEP : 0);
        changed |= state != component->state;
        system->coarse.worn |= (component->state & ~state & GXSP_ASLEEP) != 0; /* its coarse matrices are old */
        component->state = state;
    }
    if (!changed && system->state.still_known) return;
    system->state.still_known = 1;
    system->leap.served = 0;
    system->state.base_known &= !changed;
    gxsp_mark_still(system);
    system->state.active = 3 * system->model.n;
    for (i = 0; i < system->model.n; i++) system->state.active -= system->state.still[i] ? 3 : 0;
    for (i = 0; i < system->model.follower_count; i++)
        system->state.active -= system->state.still[system->model.followers[i].copy] ? 0 : 3;
}

/* Rest times after a step that has ended with these velocities */
static void gxsp_count_rest(const gxsp_problem *problem, const double *velocity) {
    const gxsp_system *system = problem->system;
    const gxs_step_desc *step = problem->step;
    size_t i;
    if (!(step->sleep_speed > 0)) return;
    for (i = 0; i < system->model.n; i++) {
        const int rests =
            !gxsp_too_fast(step, velocity + 3 * i) && !system->model.components[system->model.component[i]].woken;
        step->rest_times[i] = rests ? step->rest_times[i] + step->dt : 0;
    }
}

/* >>balance: residual, energies and the start of Newton's method --------------------------------------------------- */

/* In: a displacement. Out: energies of components, forces, the residual and its measure. */

/* Adds the forces on held copies, scaled by the mean of the other copies' D, since held ones have no D. A body that
 * only its held copies deform has no other force when it is in balance. */
static void gxsp_add_reactions(const gxsp_system *system, gxsp_norms *norms) {
    double stiffness = 0, square = 0, compliance;
    size_t i, counted = 0;
    for (i = 0; i < system->model.n; i++) {
        const float *d = system->vectors.diagonal + 6 * i;
        const double trace = (double)d[0] + (double)d[3] + (double)d[5];
        if (trace > 0) {
            stiffness += 3 / trace;
            counted++;
        }
        if (system->model.held[i]) square += gxsp_dot(system->vectors.force + 3 * i, system->vectors.force + 3 * i, 1);
    }
    compliance = stiffness > 0 ? (double)counted / stiffness : 0;
    norms->energy += square * compliance;
    norms->displacement += square * compliance * compliance;
}

/* Adds a vector's two measures by the block diagonal d. */
static void gxsp_add_norms(const float *d, const double *r, double *sums) {
    const double x = (double)d[0] * r[0] + (double)d[1] * r[1] + (double)d[2] * r[2];
    const double y = (double)d[1] * r[0] + (double)d[3] * r[1] + (double)d[4] * r[2];
    const double z = (double)d[2] * r[0] + (double)d[4] * r[1] + (double)d[5] * r[2];
    sums[0] += x * r[0] + y * r[1] + z * r[2];
    sums[1] += x * x + y * y + z * z;
}

/* residual = load - force, 0 at fixed copies. sums: measures of load, inertia and elastic forces; inertia by the
 * lumped mass */
static void gxsp_task_balance(void *context, size_t index) {
    const gxsp_pass *pass = (const gxsp_pass *)context;
    const gxsp_system *system = pass->system;
    double *sums = system->vectors.range_sum[index];
    size_t i, end = gxsp_range(system, index, &i), k;
    memset(sums, 0, sizeof *system->vectors.range_sum);
    for (; i < end; i++) {
        const float *d = system->vectors.diagonal + 6 * i;
        double load[3], inertia[3], elastic[3];
        gxsp_load(pass->problem, i, load);
        for (k = 0; k < 3; k++) {
            inertia[k] = pass->rate * system->model.lumped[i] *
                         (system->vectors.current[3 * i + k] - system->vectors.target[3 * i + k]);
            elastic[k] = system->vectors.force[3 * i + k] - inertia[k];
            system->vectors.residual[3 * i + k] =
                system->state.still[i] ? 0 : load[k] - system->vectors.force[3 * i + k];
        }
        gxsp_add_norms(d, load, sums);
        gxsp_add_norms(d, inertia, sums + 2);
        gxsp_add_norms(d, elastic, sums + 4);
    }
}

/* residual at current. Returns its size relative to load, inertia and elastic forces (see gxs_step_report). */
static double gxsp_balance(gxsp_problem *problem) {
    gxsp_system *system = problem->system;
    gxsp_norms elastic, residual;
    gxsp_pass pass;
    double energy, displacement, by_energy, by_displacement, sums[GXSP_SUMS];
    memset(&pass, 0, sizeof pass);
    pass.rate = problem->rate;
    pass.problem = problem;
    gxsp_over_ranges(system, gxsp_task_balance, &pass, sums, GXSP_SUMS);
    elastic.energy = sums[4], elastic.displacement = sums[5];
    gxsp_add_reactions(system, &elastic);
    gxsp_reduce_residual(system, system->state.still, system->vectors.residual);
    residual = gxsp_scale(system, system->vectors.residual);
    if (system->affine.count > 0) { /* by the blocks that measure load and inertia */
        double own[2] = {0, 0};
        size_t i;
        for (i = 0; i < system->model.n; i++)
            gxsp_add_norms(system->vectors.diagonal + 6 * i, system->vectors.residual + 3 * i, own);
        residual.energy = own[0], residual.displacement = own[1];
    }
    energy = sqrt(sums[0]) + sqrt(sums[2]) + sqrt(elastic.energy);
    displacement = sqrt(sums[1]) + sqrt(sums[3]) + sqrt(elastic.displacement);
    by_energy = energy > 0 ? sqrt(residual.energy) / energy : 0;
    by_displacement = displacement > 0 ? sqrt(residual.displacement) / displacement : 0;
    return by_energy > by_displacement ? by_energy : by_displacement;
}

/* The components' energies at the last evaluation become those at current. */
static void gxsp_keep_energies(gxsp_problem *problem) {
    gxsp_system *system = problem->system;
    uint32_t p;
    for (p = 0; p < system->model.component_count; p++)
        memcpy(system->model.components[p].before, system->model.components[p].energies,
               sizeof system->model.components->before);
    gxsp_sum_energies(system, problem->energies);
}

/* Energies and forces at current. 0: they are not finite. */
static int gxsp_evaluate_current(gxsp_problem *problem) {
    gxsp_system *system = problem->system;
    gxsp_evaluate(problem, system->vectors.current, 0, system->vectors.force);
    gxsp_keep_energies(problem);
    return gxsp_finite(problem->energies[0]) && gxsp_finite(problem->energies[1]) &&
           gxsp_first_not_finite(system->vectors.force, 3 * system->model.n) == 3 * system->model.n;
}

/* Base: the displacement of a step that only moves held copies to their targets, and their followers */
static void gxsp_find_base(const gxsp_problem *problem, double *to) {
    const gxsp_system *system = problem->system;
    const double *targets = problem->step->targets;
    size_t k;
    memcpy(to, problem->given, 3 * system->model.n * sizeof *to);
    for (k = 0; k < 3 * system->model.n && targets; k++)
        if (system->model.held[k / 3])
            to[k] = problem->step->integrator == GXS_MIDPOINT ? 0.5 * (to[k] + targets[k]) : targets[k];
    gxsp_follow(system, problem->given, to);
}

/* Light copies start near where inertia leads the copies that guide them. They have next to no inertia of their own.
 * If they started where they would fly, the linearisation would be that of an element torn apart. */
static void gxsp_lead_lights(const gxsp_problem *problem) {
    gxsp_system *system = problem->system;
    uint32_t i;
    size_t c;
    for (i = 0; i < system->model.light_count; i++) {
        const gxsp_light *light = &system->model.lights[i];
        double *start = system->vectors.current + 3 * (size_t)light->copy, back[3];
        const double far = gxsp_departure(system, light, system->vectors.target, problem->given, problem->given, back);
        if (!system->state.still[light->copy] && far > GXSP_FREE)
            for (c = 0; c < 3; c++) start[c] += (1 - GXSP_FREE / far) * back[c];
    }
}

/* An element's mean gradient of the way from one displacement to another, m/m: of[c][a] */
static void gxsp_affine_gradient(const gxsp_affine_block *block, int l, const double *from, const double *to,
                                 double of[3][3]) {
    int c, a, k, p;
    memset(of, 0, 9 * sizeof(double));
    for (c = 0; c < 3; c++) {
        double share[16], gradient[3];
        for (k = 0; k < 16; k++) {
            const size_t at = 3 * (size_t)block->vector[k][l] + (size_t)c;
            share[k] = block->vector[k][l] == GXSP_NONE ? 0 : to[at] - from[at];
        }
        for (p = 0; p < 4; p++) {
            gxsp_point_gradient(block, p, l, share, gradient);
            for (a = 0; a < 3; a++) of[c][a] += 0.25 * gradient[a];
        }
    }
}

/* Some fields have many descriptions by affine copies: a difference of two moves nothing, has no force and no inertia,
 * and would go on for ever. So the way from the step's start of each A goes a part nearer to the gradient of the
 * field's way around its copy. What moves nothing has no gradient, and loses that part in every step; in what turns or
 * stretches evenly both are equal; what bends differs a little in the start only. */
static void gxsp_calm_affine(const gxsp_problem *problem) {
    gxsp_system *system = problem->system;
    const gxsp_affine *affine = &system->affine;
    const double *given = problem->given;
    double *start = system->vectors.current;
    uint32_t b, g;
    int l, k, a, c;
    if (affine->count == 0) return;
    memset(affine->sum, 0, system->model.n * sizeof *affine->sum);
    for (b = 0; b < affine->block_count; b++)
        for (l = 0; l < GXSP_LANES && !affine->blocks[b].still; l++) {
            const gxsp_affine_block *block = &affine->blocks[b];
            const double weight = block->rest.weight[l];
            double gradient[3][3];
            if (!(weight > 0)) continue;
            gxsp_affine_gradient(block, l, given, start, gradient);
            for (k = 0; k < 4; k++) {
                if (block->vector[4 + 3 * k][l] == GXSP_NONE) continue;
                affine->sum[block->vector[k][l]][0] += weight;
                for (a = 0; a < 3; a++)
                    for (c = 0; c < 3; c++) affine->sum[block->vector[4 + 3 * k + a][l]][c] += weight * gradient[c][a];
            }
        }
    for (g = 0; g < affine->group_count; g++) {
        const double weight = affine->sum[affine->member[g][0]][0];
        for (a = 1; a < 4 && weight > 0 && !system->state.still[affine->member[g][0]]; a++)
            for (c = 0; c < 3; c++) {
                const uint32_t vector = affine->member[g][a];
                const size_t at = 3 * (size_t)vector + (size_t)c;
                start[at] -= GXSP_CALM * (start[at] - given[at] - affine->length / weight * affine->sum[vector][c]);
            }
    }
}

/* Starts Newton's method at base, or where inertia leads; each loose component is translated so that its momentum
 * balances. The iteration cannot change momentum: elastic forces have none, and directions balance it. */
static int gxsp_start(gxsp_problem *problem, int led) {
    gxsp_system *system = problem->system;
    size_t i;
    gxsp_find_base(problem, system->vectors.current);
    for (i = 0; i < system->model.n && led; i++)
        if (!system->state.still[i])
            memcpy(system->vectors.current + 3 * i, system->vectors.target + 3 * i, 3 * sizeof(double));
    if (led) gxsp_calm_affine(problem);
    if (led) gxsp_lead_lights(problem);
    gxsp_follow(system, problem->given, system->vectors.current);
    gxsp_untouch_components(system);
    gxsp_terms_make(problem, system->vectors.current);
    gxsp_balance_momentum(problem, 0, NULL, system->vectors.current);
    return gxsp_first_not_finite(system->vectors.current, 3 * system->model.n) == 3 * system->model.n &&
           gxsp_evaluate_current(problem);
}

/* >>search: the line search ---------------------------------------------------------------------------------------- */

/* In: current and direction. Out: current at the point found, its energies and forces, a length for each
 * component. The trial displacement has the residual's memory. */

/* Bounds the direction of light copies: relative to the copies that guide them, at most as far as they are apart,
 * at rest or now, unless the component's descent depends on it. E hardly shows a copy of so little weight, so the
 * line search could not find a length for it. Later iterations, which few steps have, are left alone: they converge
 * by themselves. */
static void gxsp_bound_lights(const gxsp_problem *problem) {
    gxsp_system *system = problem->system;
    double *direction = system->vectors.direction;
    uint32_t i;
    size_t c;
    int any = 0;
    if (!system->model.positions || problem->report.newton_iterations >= GXSP_BOUNDED) return;
    for (i = 0; i < system->model.light_count; i++) {
        const gxsp_light *light = &system->model.lights[i];
        const size_t copy = light->copy;
        const double *force = system->vectors.force + 3 * copy;
        gxsp_component *component = gxsp_lead_of(system, copy);
        double back[3], load[3], work;
        const double far = gxsp_departure(system, light, direction, NULL, system->vectors.current, back);
        if (system->state.still[copy] || gxsp_follows(system, copy) || !(far > 1)) continue;
        for (c = 0; c < 3; c++) back[c] *= 1 - 1 / far;
        gxsp_load(problem, copy, load);
        work = gxsp_dot(load, back, 1);
        if (gxsp_dot(force, back, 1) - work > GXSP_BOUND_COST * -component->slope) continue;
        component->slope += gxsp_dot(force, back, 1) - work;
        component->work += work;
        for (c = 0; c < 3; c++) direction[3 * copy + c] += back[c];
        any = 1;
    }
    if (any) {
        gxsp_follow(system, NULL, direction);
        gxsp_balance_direction(problem);
        gxsp_balance_islands(problem);
    }
}

/* Slopes, rounding and first lengths of the components. Linear solves end by a measure of all components together.
 * They may leave one that weighs next to nothing far beyond the minimum of its own linear model: it starts at that
 * minimum. 0: a number is not finite. */
static int gxsp_begin_search(const gxsp_problem *problem) {
    gxsp_system *system = problem->system;
    int finite = 1;
    size_t i, k;
    uint32_t p;
    for (p = 0; p < system->model.component_count; p++) {
        gxsp_component *component = &system->model.components[p];
        component->slope = component->work = component->rounding = 0;
        component->length = 1;
    }
    for (i = 0; i < system->model.n; i++) {
        gxsp_component *component = gxsp_lead_of(system, i);
        const double *force = system->vectors.force + 3 * i, *way = system->vectors.direction + 3 * i;
        double load[3], work, rounding = 0;
        gxsp_load(problem, i, load);
        work = gxsp_dot(load, way, 1);
        for (k = 0; k < 3; k++)
            rounding += fabs(force[k] * system->vectors.current[3 * i + k]) + fabs(load[k] * way[k]);
        component->slope += gxsp_dot(force, way, 1) - work;
        component->work += work;
        component->rounding += rounding;
    }
    gxsp_bound_lights(problem);
    for (p = 0; p < system->model.component_count; p++) {
        gxsp_component *component = &system->model.components[p];
        const double curvature = -component->slope - component->left; /* of the linear model */
        finite &= gxsp_finite(component->slope);
        if (component->slope < 0 && -component->slope < GXSP_TOO_LONG * curvature)
            component->length = -component->slope / curvature;
    }
    return finite;
}

/* Has the component gone down far enough? If not, it will try a shorter length. */
static void gxsp_judge_length(gxsp_problem *problem, gxsp_component *component) {
    const double *now = component->energies, *before = component->before, length = component->length,
                 promise = length * component->slope;
    const double change = (now[0] - before[0]) + (now[1] - before[1]) - length * component->work;
    const double slack = 1e-15 * (now[2] + before[2] + component->rounding);
    double next;
    if (gxsp_finite(change) && gxsp_finite(now[2]) && change <= (promise < 0 ? GXSP_ARMIJO * promise : 0) + slack) {
        problem->noise &= fabs(change) <= slack;
        component->settled = 1;
        return;
    }
    /* minimum of the parabola through the two energies and the slope, within 1/10 to 1/2 of the length */
    next = gxsp_finite(change) && change > promise ? -0.5 * promise * length / (change - promise) : 0.1 * length;
    next = next < 0.1 * length ? 0.1 * length : next > 0.5 * length ? 0.5 * length : next;
    component->length = promise < 0 ? next : 0;
}

/* Energies and forces at trial = current + each component's length of the direction */
static void gxsp_try_lengths(gxsp_problem *problem) {
    gxsp_system *system = problem->system;
    size_t i, k;
    for (i = 0; i < system->model.n; i++) {
        const double length = gxsp_lead_of(system, i)->length;
        for (k = 3 * i; k < 3 * i + 3; k++)
            gxsp_trial(system)[k] = system->vectors.current[k] + length * system->vectors.direction[k];
    }
    gxsp_evaluate(problem, gxsp_trial(system), 0, system->vectors.force);
}

/* Components that have found no length stay. Returns how many went down; left: how many stay. */
static size_t gxsp_end_search(gxsp_system *system, size_t *left) {
    size_t down = 0;
    uint32_t p;
    *left = 0;
    for (p = 0; p < system->model.component_count; p++) {
        gxsp_component *component = &system->model.components[p];
        if (component->lead != p) continue;
        down += component->settled && component->slope < 0;
        *left += !component->settled;
        component->length = component->settled ? component->length : 0;
    }
    return down;
}

/* Does Newton's method go on until affine copies have settled? */
static int gxsp_settles(const gxsp_problem *problem) {
    return problem->system->affine.count > 0 && problem->step->newton_iterations == 0 &&
           problem->step->integrator != GXS_STATIC;
}

/* Motion of affine copies from the memory of `before` to current, as a share of that since the step's start: root of
 * the mean square by mass; the largest of all components. 0: none of them has moved. */
static double gxsp_share_moved(const gxsp_problem *problem, const double *before) {
    const gxsp_system *system = problem->system;
    double share = 0;
    uint32_t g, p;
    int k;
    for (p = 0; p < system->model.component_count; p++)
        system->model.components[p].sum[0] = system->model.components[p].sum[1] = 0;
    for (g = 0; g < system->affine.group_count; g++) {
        const size_t copy = system->affine.member[g][0];
        double *sum = gxsp_lead_of(system, copy)->sum;
        for (k = 0; k < 3; k++) {
            const double last = system->vectors.current[3 * copy + (size_t)k] - before[3 * copy + (size_t)k],
                         all = system->vectors.current[3 * copy + (size_t)k] - problem->given[3 * copy + (size_t)k];
            sum[0] += system->model.lumped[copy] * last * last;
            sum[1] += system->model.lumped[copy] * all * all;
        }
    }
    for (p = 0; p < system->model.component_count; p++) {
        const double *sum = system->model.components[p].sum;
        if (sum[1] > 0) share = fmax(share, sqrt(sum[0] / sum[1]));
    }
    return share;
}

/* A step length for each component along the direction, by backtracking on E. E is a sum over components: it falls
 * in each of them, and none waits for another. current becomes the point found, with its forces and energies. 0: no
 * finite point of lower energy was found. */
static int gxsp_line_search(gxsp_problem *problem) {
    gxsp_system *system = problem->system;
    double *found = gxsp_trial(system);
    size_t left = 1, down;
    uint32_t p;
    int trial;
    if (!gxsp_begin_search(problem)) return 0;
    problem->noise = 1;
    for (trial = 0; trial < GXSP_TRIALS && left > 0 && (trial == 0 || !gxsp_out_of_time(problem)); trial++) {
        problem->report.line_search_steps++;
        gxsp_try_lengths(problem);
        for (p = 0, left = 0; p < system->model.component_count; p++) {
            gxsp_component *component = &system->model.components[p];
            if (component->lead == p && !component->settled) gxsp_judge_length(problem, component);
            left += component->lead == p && !component->settled;
        }
    }
    problem->shortened = trial > 1;
    down = gxsp_end_search(system, &left);
    if (left > 0) gxsp_try_lengths(problem);
    for (p = 0; p < system->model.component_count; p++) system->model.components[p].settled = 0;
    gxsp_keep_energies(problem);
    system->vectors.residual = system->vectors.current;
    system->vectors.current = found;
    if (gxsp_settles(problem)) problem->moved = gxsp_share_moved(problem, system->vectors.residual);
    return left == 0 || down > 0;
}

/* >>integrators: BDF1, BDF2, midpoint, statics --------------------------------------------------------------------- */

/* In: the step and the state at its start. Out: rate, speed, target and the load of damping. */

/* The step's integrator as rate and target: the equation of motion is M rate (u - target) = f - dU/du, and
 * v = speed (u - mean).
 *   BDF1      speed = 1 / dt, mean = u_n; rate = speed^2, target = mean + v_n / speed
 *   BDF2      r = dt / dt of the step before; a0 = (1 + 2 r) / (1 + r), a1 = -(1 + r), a2 = r^2 / (1 + r);
 *             speed = a0 / dt, mean = -(a1 u_n + a2 u_n-1) / a0; target = mean + mean of v / speed
 *   midpoint  u is the displacement at half the step: BDF1 of half the step, finished in gxsp_finish
 *   static    speed = 0, rate = 1 / dt^2 or 0, target = u_n */
static void gxsp_choose_integrator(gxsp_problem *problem) {
    const gxs_step_desc *step = problem->step;
    double dt = step->integrator == GXS_MIDPOINT ? 0.5 * step->dt : step->dt;
    problem->mean[0] = 1;
    problem->mean[1] = 0;
    if (step->integrator == GXS_STATIC) {
        problem->speed = 0;
        problem->rate = dt > 0 ? 1 / (dt * dt) : 0;
        return;
    }
    problem->speed = 1 / dt;
    if (step->integrator == GXS_BDF2 && step->previous_displacement) {
        double r = dt / step->previous_dt, first = (1 + 2 * r) / (1 + r);
        problem->speed = first / dt;
        problem->mean[0] = (1 + r) / first;
        problem->mean[1] = -r * r / (1 + r) / first;
    }
    problem->rate = problem->speed * problem->speed + problem->speed * step->mass_damping;
}

/* Adds elastic forces at a displacement, with moduli times damping x factor, to the load of damping. */
static void gxsp_add_damping(gxsp_problem *problem, double factor, const double *displacement) {
    gxsp_system *system = problem->system;
    size_t i;
    for (i = 0; i < system->model.material_count; i++) {
        system->state.damped[i].mu = factor * system->model.materials[i].damping * system->model.materials[i].mu;
        system->state.damped[i].lambda =
            factor * system->model.materials[i].damping * system->model.materials[i].lambda;
    }
    gxsp_evaluate_elements(system, 0, displacement, system->vectors.target, 0, system->vectors.force);
    for (i = 0; i < 3 * system->model.n; i++) system->vectors.damping[i] += system->vectors.force[i];
}

/* Rayleigh's stiffness damping: stress P(F) + beta dP/dt, where dP/dt is speed times (P(F) - P at the integrator's
 * mean). Energies are linear in their moduli, so this is the energy (1 + beta speed) U(u) and a load of the earlier
 * forces. These forces are rotated with the motion by inertia alone, so that rotations under stress are not damped, to
 * first order in the step. */
static void gxsp_begin_damping(gxsp_problem *problem) {
    gxsp_system *system = problem->system;
    size_t i;
    problem->damps = system->model.damps && problem->speed > 0;
    if (problem->damps) {
        system->state.base_known = 0;
        memset(system->vectors.damping, 0, 3 * system->model.n * sizeof(double));
        gxsp_add_damping(problem, problem->speed * problem->mean[0], problem->given);
        if (problem->mean[1] < 0)
            gxsp_add_damping(problem, problem->speed * problem->mean[1], problem->step->previous_displacement);
    }
    for (i = 0; i < system->model.material_count; i++) {
        const double factor = 1 + problem->speed * system->model.materials[i].damping;
        system->state.damped[i] = system->model.materials[i];
        system->state.damped[i].mu *= factor;
        system->state.damped[i].lambda *= factor;
    }
}

/* Mean of the displacements before. displacement: at the step's start */
static double gxsp_mean(const gxsp_problem *problem, const double *displacement, size_t k) {
    double mean = problem->mean[0] * displacement[k];
    return problem->mean[1] < 0 ? mean + problem->mean[1] * problem->step->previous_displacement[k] : mean;
}

/* Target and load of damping */
static void gxsp_begin(gxsp_problem *problem, const double *velocity) {
    gxsp_system *system = problem->system;
    const gxs_step_desc *step = problem->step;
    const double *displacement = problem->given;
    /* s; mass damping makes up the rest of the rate */
    const double lead = problem->speed > 0 ? problem->speed / problem->rate : 0;
    size_t k;
    system->state.base_known = system->state.base_known && !step->targets && gxsp_point_count(step) == 0 &&
                               memcmp(displacement, system->vectors.current, 3 * system->model.n * sizeof(double)) == 0;
    for (k = 0; k < 3 * system->model.n; k++) {
        double speed = problem->mean[0] * velocity[k];
        if (problem->mean[1] < 0) speed += problem->mean[1] * step->previous_velocity[k];
        system->vectors.target[k] = gxsp_mean(problem, displacement, k) + lead * speed;
        /* the acceleration of a held copy acts on its neighbours */
        if (system->state.still[k / 3] && !system->model.held[k / 3]) system->vectors.target[k] = displacement[k];
    }
    gxsp_begin_damping(problem);
}

/* >>newton: Newton's method, and the bound on E -------------------------------------------------------------------- */

/* In: target and base. Out: current, where E is no higher than at base in any component. */

static int gxsp_linearise_all(gxsp_problem *problem) {
    gxsp_system *system = problem->system;
    const double start = gxsp_now(problem);
    int finite;
    gxsp_terms_make(problem, system->vectors.current);
    finite = gxsp_linearise(system, problem->rate, system->vectors.current, problem->exact, &problem->collapsed);
    problem->report.seconds_linearise += gxsp_now(problem) - start;
    return finite;
}

/* Elements collapsed to a point have no force that would open them. For the direction and its slope they get the
 * force of an element that has all but collapsed. Energies stay as they are. */
static void gxsp_nudge_forces(gxsp_problem *problem) {
    gxsp_evaluate(problem, problem->system->vectors.current, 1, problem->system->vectors.force);
    gxsp_balance(problem);
}

/* The next direction. Near the end, where projected Hessians converge slowly, the exact one is tried; if it proves
 * indefinite, the projected one serves from there on. */
static int gxsp_find_direction(gxsp_problem *problem) {
    if (!gxsp_solve(problem)) return 0;
    if (!problem->exact || !problem->indefinite) return 1;
    problem->exact = 0;
    problem->projected_only = 1;
    if (!gxsp_linearise_all(problem)) return 0;
    gxsp_balance(problem);
    return gxsp_solve(problem);
}

/* Does Newton's method continue? If not, report.stop says why. before: the residual an iteration ago */
static int gxsp_continues(gxsp_problem *problem, double before) {
    const gxs_step_desc *step = problem->step;
    const uint32_t budget = (step->newton_iterations ? step->newton_iterations
                             : gxsp_settles(problem) ? GXSP_SHEETS_MOST
                                                     : 1) +
                            problem->added,
                   done = problem->report.newton_iterations;
    const double wanted = step->newton_tolerance > 0 ? step->newton_tolerance : 1e-8,
                 goal = wanted > GXSP_ROUNDING ? wanted : GXSP_ROUNDING;
    const double residual = problem->report.residual;
    problem->report.stop = GXS_STOP_BALANCE;
    if (residual <= goal && !problem->collapsed) return 0;
    problem->stalls = done > 0 && problem->noise && residual > 0.9 * problem->least ? problem->stalls + 1 : 0;
    problem->least = done == 0 || residual < problem->least ? residual : problem->least;
    problem->report.stop = GXS_STOP_ROUNDING;
    if (problem->stalls > GXSP_STALLS) return 0;
    problem->report.stop = GXS_STOP_ITERATIONS;
    if (gxsp_out_of_time(problem) || done == budget) return 0;
    if (done > 0 && gxsp_settles(problem) && problem->moved <= GXSP_SETTLED) return 0;
    problem->exact =
        done > 0 && !problem->projected_only && !problem->shortened && residual < 0.1 && residual > 0.1 * before;
    return 1;
}

/* Newton's method, to balance or to the end of the budget, from a start that gxsp_start found finite or from where
 * it has ended. */
static gx_result gxsp_newton(gxsp_problem *problem) {
    uint32_t *done = &problem->report.newton_iterations;
    double before = 0;
    problem->exact = problem->projected_only = problem->stalls = problem->shortened = 0;
    if (*done == 0 && !gxsp_linearise_all(problem)) return GX_ERROR_DIVERGED;
    for (;;) {
        problem->report.residual = gxsp_balance(problem);
        if (!gxsp_finite(problem->report.residual)) return GX_ERROR_DIVERGED;
        if (!gxsp_continues(problem, before)) return GX_OK;
        before = problem->report.residual;
        if (*done > 0 && !gxsp_linearise_all(problem)) break;
        if (problem->collapsed) gxsp_nudge_forces(problem);
        if (!gxsp_find_direction(problem) || !gxsp_line_search(problem)) break;
        (*done)++;
    }
    /* no further progress; after a first success the state is lower than the start */
    if (problem->report.stop != GXS_STOP_SECONDS) problem->report.stop = GXS_STOP_ROUNDING;
    return *done > 0 || problem->report.stop == GXS_STOP_SECONDS ? GX_OK : GX_ERROR_DIVERGED;
}

/* E of every component at current, and its limit: E at a displacement at which all were evaluated last, or, with
 * elastic, at another one without the kinetic energy */
static void gxsp_limit_energies(const gxsp_problem *problem, const double *displacement, int elastic) {
    gxsp_system *system = problem->system;
    size_t i;
    uint32_t p;
    for (p = 0; p < system->model.component_count; p++) {
        gxsp_component *component = &system->model.components[p];
        component->limit = elastic ? component->base_energy : component->energies[0] + component->energies[1];
        component->ended = component->before[0] + component->before[1];
    }
    for (i = 0; i < system->model.n; i++) {
        gxsp_component *component = gxsp_lead_of(system, i);
        double load[3];
        gxsp_load(problem, i, load);
        component->limit -= gxsp_dot(load, displacement + 3 * i, 1);
        component->ended -= gxsp_dot(load, system->vectors.current + 3 * i, 1);
    }
}

/* Counts the components that have ended above their limit by more than rounding; risen marks them. */
static size_t gxsp_count_risen(gxsp_system *system) {
    size_t count = 0;
    uint32_t p;
    for (p = 0; p < system->model.component_count; p++) {
        gxsp_component *component = &system->model.components[p];
        const double slack = 1e-12 * fabs(component->limit) + GXSP_ROUNDING * component->before[2];
        component->risen =
            component->lead == p && gxsp_finite(component->limit) && component->ended > component->limit + slack;
        count += component->risen != 0;
    }
    return count;
}

/* Base, with loose components translated so that their momentum balances: into trial */
static void gxsp_translate_base(gxsp_problem *problem) {
    gxsp_find_base(problem, gxsp_trial(problem->system));
    gxsp_balance_momentum(problem, 0, NULL, gxsp_trial(problem->system));
}

/* E of every component at base, once the limits are E at trial, to which loose components were translated: E is a
 * parabola along the translation. */
static void gxsp_note_base(const gxsp_problem *problem) {
    gxsp_system *system = problem->system;
    uint32_t p;
    for (p = 0; p < system->model.component_count; p++)
        system->model.components[p].base = system->model.components[p].limit;
    for (p = 0; p < system->model.component_count; p++) {
        const gxsp_component *component = &system->model.components[p];
        if (component->state == 0)
            system->model.components[component->lead].base +=
                0.5 * component->mass * gxsp_dot(component->sum, component->sum, 1) / problem->rate;
    }
}

/* Puts components whose E exceeds that at trial back there. From there they go towards where they were, as far as E
 * falls. Returns how many there were. */
static size_t gxsp_bring_down(gxsp_problem *problem) {
    gxsp_system *system = problem->system;
    size_t i, k, count;
    uint32_t p;
    gxsp_evaluate(problem, gxsp_trial(system), 0, system->vectors.force);
    gxsp_limit_energies(problem, gxsp_trial(system), 0);
    gxsp_note_base(problem);
    problem->based = 1;
    count = gxsp_count_risen(system);
    if (count == 0) return 0;
    for (i = 0; i < system->model.n; i++) {
        const int risen = gxsp_lead_of(system, i)->risen;
        for (k = 3 * i; k < 3 * i + 3; k++) {
            system->vectors.direction[k] = risen ? system->vectors.current[k] - gxsp_trial(system)[k] : 0;
            system->vectors.current[k] = risen ? gxsp_trial(system)[k] : system->vectors.current[k];
        }
    }
    for (p = 0; p < system->model.component_count; p++) {
        system->model.components[p].left = 0;
        if (system->model.components[p].risen)
            memcpy(system->model.components[p].before, system->model.components[p].energies,
                   sizeof system->model.components->before);
    }
    if (!gxsp_line_search(problem)) (void)gxsp_evaluate_current(problem);
    return count;
}

/* Newton's method from target, which is close to the answer except in violent motion. A component whose E ends higher
 * than at base (translated by its momentum if it is loose) goes from base towards its end as far as E falls. Newton's
 * method then continues with the iterations that are left. So E(u) <= E(base) in each component, which bounds the
 * energy that a step can add. */
static gx_result gxsp_minimise(gxsp_problem *problem) {
    gxsp_system *system = problem->system;
    gx_result result = GX_ERROR_DIVERGED;
    if (system->state.active == 0) {
        gxsp_find_base(problem, system->vectors.current);
        problem->report.stop = GXS_STOP_ASLEEP;
        return GX_OK;
    }
    gxsp_choose_leads(problem);
    if (gxsp_start(problem, 1)) result = gxsp_newton(problem);
    if (result != GX_OK) {
        problem->report.newton_iterations = 0;
        return gxsp_start(problem, 0) ? gxsp_newton(problem) : GX_ERROR_DIVERGED;
    }
    gxsp_translate_base(problem);
    gxsp_limit_energies(problem, gxsp_trial(system), 1);
    if (system->state.base_known && problem->step->integrator != GXS_MIDPOINT && gxsp_count_risen(system) == 0)
        return GX_OK; /* lower than base even without the kinetic energy that staying there would take */
    if (gxsp_bring_down(problem) == 0) return GX_OK;
    /* Under pairs one iteration from where inertia leads often ends above base, as friction sticks there. Without
     * another one, from base, whole piles would stand still for a step. */
    problem->added = problem->step->pair_count > 0;
    return gxsp_newton(problem);
}

/* >>midpoint: the second half of the midpoint rule, and the end of a step ------------------------------------------ */

/* In: current, where Newton's method has ended. Out: the caller's displacement, velocity, rest times and spring
 * forces, and what the next step is told. */

/* gain = E of every component at a displacement, minus that at base. evaluated: 1: the displacement was evaluated
 * last; 0: it is current */
static void gxsp_find_gains(const gxsp_problem *problem, const double *displacement, int evaluated) {
    gxsp_system *system = problem->system;
    size_t i;
    uint32_t p;
    for (p = 0; p < system->model.component_count; p++) {
        gxsp_component *component = &system->model.components[p];
        const double *energies = evaluated ? component->energies : component->before;
        component->gain = energies[0] + energies[1] - component->base;
    }
    for (i = 0; i < system->model.n; i++) {
        double load[3];
        gxsp_load(problem, i, load);
        gxsp_lead_of(system, i)->gain -= gxsp_dot(load, displacement + 3 * i, 1);
    }
}

/* Components on which springs or contact act at a displacement are not loose any more. */
static void gxsp_touch_components_at(const gxsp_problem *problem, const double *displacement) {
    gxsp_system *system = problem->system;
    const gxs_point *point;
    gxsp_pull pull;
    size_t next = 0;
    uint32_t k;
    while ((point = gxsp_next_pull(problem, &next, displacement, &pull)) != NULL)
        for (k = 0; k < point->count && (fabs(pull.energy) > 0 || gxsp_dot(pull.force, pull.force, 1) > 0); k++)
            if (fabs(gxsp_weights(point)[k]) > 0)
                system->model.components[system->model.component[gxsp_copies(point)[k]]].state |= GXSP_TOUCHED;
}

/* Is the second half short enough for the component? If not, it will try a shorter one, in the end none: E is about
 * a parabola whose minimum, low, is where nothing of the second half is left. */
static void gxsp_judge_gain(gxsp_component *component, int last) {
    const double low = component->low, gain = component->gain;
    double next;
    if (gxsp_finite(gain) && gain <= GXSP_GAIN * component->energies[1] + 1e-12 * fabs(component->base) +
                                         GXSP_ROUNDING * component->energies[2]) {
        component->settled = 1;
        return;
    }
    next = gxsp_finite(gain) && low < 0 && gain > low ? component->length * sqrt(low / (low - gain)) : 0;
    component->length = last ? 0 : next < 0.1 * component->length ? 0.1 * component->length : next;
}

/* Light copies keep their place beside the copies that guide them: in x, n x 3, they move by nearly the mean of these.
 */
static void gxsp_guide_lights(const gxsp_system *system, double *x) {
    uint32_t i;
    size_t c;
    for (i = 0; i < system->model.light_count; i++) {
        const gxsp_light *light = &system->model.lights[i];
        double back[3];
        const double far = gxsp_departure(system, light, x, NULL, system->vectors.current, back);
        if (!system->state.still[light->copy] && !gxsp_follows(system, light->copy) && far > GXSP_FREE)
            for (c = 0; c < 3; c++) x[3 * (size_t)light->copy + c] += (1 - GXSP_FREE / far) * back[c];
    }
}

/* The drift of number i of a vector */
static double gxsp_drift(const gxsp_system *system, size_t i) {
    return gxsp_is_hidden(system, i / 3) ? 0 : system->model.components[system->model.component[i / 3]].drift[i % 3];
}

/* The second half of the midpoint rule from current: drift of loose components, and direction. Components on which
 * springs or contact act at its end are not loose. trial: that end. */
static void gxsp_find_second_half(const gxsp_problem *problem) {
    gxsp_system *system = problem->system;
    const size_t count = 3 * system->model.n;
    size_t i;
    uint32_t p;
    gxsp_find_base(problem, gxsp_trial(system));
    for (i = 0; i < count; i++) system->vectors.direction[i] = system->vectors.current[i] - gxsp_trial(system)[i];
    gxsp_clear_components(system); /* nothing else does if none is loose */
    gxsp_remove_momentum(system, system->vectors.direction);
    for (p = 0; p < system->model.component_count; p++)
        memcpy(system->model.components[p].drift, system->model.components[p].sum,
               sizeof system->model.components->drift);
    gxsp_guide_lights(system, system->vectors.direction);
    gxsp_remove_momentum(system, system->vectors.direction);
    for (i = 0; i < count; i++)
        gxsp_trial(system)[i] = system->vectors.current[i] + (system->vectors.direction[i] + gxsp_drift(system, i));
    gxsp_touch_components_at(problem, gxsp_trial(system));
    for (i = 0; i < count; i++)
        system->vectors.direction[i] = system->model.components[system->model.component[i / 3]].state == 0
                                         ? system->vectors.direction[i]
                                         : gxsp_trial(system)[i] - system->vectors.current[i];
    for (p = 0; p < system->model.component_count; p++) { /* a drift has its own share of the kinetic energy */
        gxsp_component *component = &system->model.components[p];
        if (component->state == 0)
            system->model.components[component->lead].low +=
                0.5 * problem->rate * component->mass * gxsp_dot(component->drift, component->drift, 1);
        else
            memset(component->drift, 0, sizeof component->drift);
    }
}

/* The midpoint rule continues from current by the way from base to current. E there is the energy at the end, as
 * E(base) is that at the start. The two differ by terms of third order in the way, by springs and contact that first
 * act beyond current, and by the errors of Newton's method and conjugate gradients, which would add up from step to
 * step without bound. If a component would gain more than a share of its kinetic energy, its second half is shortened,
 * except the translation of a component on which nothing acts at either place. At worst the step ends at current, where
 * E is not above E(base). Light copies move with the copies that guide them, since nothing would damp them. direction
 * becomes the end. */
static void gxsp_bound_gain(gxsp_problem *problem) {
    gxsp_system *system = problem->system;
    const size_t count = 3 * system->model.n;
    size_t i, left = 1;
    uint32_t p;
    int trial;
    /* springs and contact may begin to act anywhere */
    if (!problem->based || gxsp_point_count(problem->step) > 0) {
        gxsp_find_base(problem, gxsp_trial(system));
        gxsp_evaluate(problem, gxsp_trial(system), 0, system->vectors.force);
        for (p = 0; p < system->model.component_count; p++) system->model.components[p].base = 0;
        gxsp_find_gains(problem, gxsp_trial(system), 1);
        for (p = 0; p < system->model.component_count; p++)
            system->model.components[p].base = system->model.components[p].gain;
    }
    gxsp_find_gains(problem, system->vectors.current, 0);
    for (p = 0; p < system->model.component_count; p++) {
        system->model.components[p].low = system->model.components[p].gain;
        system->model.components[p].length = 1;
    }
    gxsp_find_second_half(problem);
    for (trial = 0; trial < GXSP_GAIN_TRIALS && left > 0; trial++) {
        for (i = 0; i < count; i++)
            gxsp_trial(system)[i] =
                system->vectors.current[i] +
                (gxsp_drift(system, i) + gxsp_lead_of(system, i / 3)->length * system->vectors.direction[i]);
        gxsp_evaluate(problem, gxsp_trial(system), 0, system->vectors.force);
        gxsp_find_gains(problem, gxsp_trial(system), 1);
        for (p = 0, left = 0; p < system->model.component_count; p++) {
            gxsp_component *component = &system->model.components[p];
            if (component->lead == p && !component->settled) gxsp_judge_gain(component, trial + 2 >= GXSP_GAIN_TRIALS);
            left += component->lead == p && !component->settled;
        }
    }
    for (i = 0; i < count; i++)
        system->vectors.direction[i] =
            gxsp_lead_of(system, i / 3)->settled ? gxsp_trial(system)[i] : system->vectors.current[i];
    for (p = 0; p < system->model.component_count; p++) system->model.components[p].settled = 0;
}

/* E at a displacement whose energies are given, J */
static double gxsp_potential(const gxsp_problem *problem, const double *energies, const double *displacement) {
    double work = 0;
    size_t i;
    for (i = 0; i < problem->system->model.n; i++) {
        double load[3];
        gxsp_load(problem, i, load);
        work += gxsp_dot(load, displacement + 3 * i, 1);
    }
    return energies[0] + energies[1] - work;
}

/* The state at the end of an implicit step: velocity into residual, displacement into direction; and E there */
static void gxsp_find_end(gxsp_problem *problem, const double *displacement, const double *velocity) {
    gxsp_system *system = problem->system;
    const gxs_step_desc *step = problem->step;
    const int midpoint = step->integrator == GXS_MIDPOINT, bounded = midpoint && system->state.active > 0;
    size_t i, count = 3 * system->model.n;
    double *speeds = system->vectors.residual, *ends = system->vectors.direction;
    if (bounded) gxsp_bound_gain(problem);
    for (i = 0; i < count; i++)
        if (!bounded || system->state.still[i / 3])
            ends[i] = midpoint ? 2 * system->vectors.current[i] - displacement[i] : system->vectors.current[i];
    gxsp_follow(system, displacement, ends);
    for (i = 0; i < count; i++) {
        if (system->state.still[i / 3])
            speeds[i] = step->integrator == GXS_STATIC ? 0 : (ends[i] - displacement[i]) / step->dt;
        else
            speeds[i] = problem->speed * (ends[i] - gxsp_mean(problem, displacement, i)) - (midpoint ? velocity[i] : 0);
    }
    problem->report.energy = gxsp_potential(problem, problem->energies, system->vectors.current);
}

/* Writes the state out, residual and direction: all of it, or none if a number is not finite. */
static gx_result gxsp_finish(gxsp_problem *problem, double *displacement, double *velocity) {
    gxsp_system *system = problem->system;
    const gxs_step_desc *step = problem->step;
    const int midpoint = step->integrator == GXS_MIDPOINT;
    size_t i, count = 3 * system->model.n;
    const double *speeds = system->vectors.residual, *ends = system->vectors.direction;
    if (gxsp_first_not_finite(speeds, count) < count || gxsp_first_not_finite(ends, count) < count ||
        !gxsp_finite(problem->report.energy))
        return GX_ERROR_DIVERGED;
    gxsp_report_pairs(problem, ends);
    memcpy(displacement, ends, count * sizeof(double));
    memcpy(velocity, speeds, count * sizeof(double));
    /* followers, which current has moved with their masters by each direction, are rounded otherwise in ends */
    if (midpoint || problem->report.substeps > 0 || problem->report.quick || system->model.follower_count > 0)
        memcpy(system->vectors.current, ends, count * sizeof(double));
    system->state.stepped = 1;
    system->state.base_known = !midpoint && !problem->report.quick && gxsp_point_count(step) == 0 &&
                               (system->model.follower_count == 0 || problem->report.substeps > 0);
    system->leap.known = problem->report.quick != 0;
    system->lasting->scene = problem->scene;
    for (i = 0; i < system->model.component_count; i++) {
        system->model.components[i].forces[0] = system->model.components[i].forces[1];
        system->model.components[i].has_spring[0] = system->model.components[i].has_spring[1];
        system->model.components[i].has_pair[0] = system->model.components[i].has_pair[1];
        system->model.components[i].base_energy = system->model.components[i].before[0];
    }
    gxsp_count_rest(problem, velocity);
    return GX_OK;
}

/* The force of every spring on the body at the end of the step */
static void gxsp_report_springs(const gxsp_problem *problem) {
    const gxs_step_desc *step = problem->step;
    size_t i;
    for (i = 0; i < step->spring_count && step->spring_forces; i++) {
        gxsp_pull pull;
        gxsp_spring_pull(&step->springs[i], problem->system->vectors.current, &pull);
        memcpy(step->spring_forces + 3 * i, pull.force, sizeof pull.force);
    }
}

/* >>leapfrog: explicit steps --------------------------------------------------------------------------------------- */

/* In: the step and the state at its start. Out: the state at its end in direction and residual, or nothing where
 * the step must be implicit. Passes use the chunks' slots.
 *
 * Leapfrog takes substeps of h: u += h/2 v, v += h a(u), u += h/2 v. Alone it is stable for h^2 K <= 4 M. Here
 * a = P M^-1 (f - dU/du) with a polynomial P in X = h^2 M^-1 L, where L >= K is the stiffness of a scalar field with
 * the largest modulus of the material: one number for each pair of copies. With Chebyshev's T of degree d,
 *
 *     X P(X) = 2 - 2 T_d(1 - X / (2 d^2)),    P(0) = 1,
 *
 * is at most 4 for X up to 4 d^2. So h may be d times as long, and a product by L is far cheaper than forces are. P is
 * symmetric and positive: this is leapfrog with the mass M P^-1, second order and reversible. Waves that are slow
 * beside h keep their inertia to h^2 K / 12. A factor on L, from the moduli at the present strain, chooses d for each
 * substep.
 */

/* The largest modulus of a lane's Hessian at rest, 3 lambda + 2 mu of small strain, times the weight, J. The block's
 * moduli are those of [Smith 2018]. */
static float gxsp_leap_modulus(const gxsp_leap_block *block, int lane) {
    return 3 * block->lambda[lane] - 0.375f * block->mu[lane];
}

/* Are all elements stable neo-Hookean, undamped, and does no copy follow others or move affinely? */
static int gxsp_leap_suits(const gxsp_system *system) {
    uint32_t c;
    if (system->model.follower_count > 0 || system->model.damps || system->affine.count > 0) return 0;
    for (c = 0; c < system->mesh.chunk_count; c++)
        if (system->mesh.chunks[c].kind != GXS_STABLE_NEO_HOOKEAN) return 0;
    return 1;
}

/* Gradients and moduli of all blocks, and the copies of all lanes: 4 each; GXSP_NONE: no element. The caller's scratch
 */
static uint32_t *gxsp_leap_blocks_make(gxsp_system *system, gxsp_pool *scratch) {
    gxsp_leap *leap = &system->leap;
    uint32_t *copies, c, b, lane, count = 0;
    int k;
    leap->first_block = (uint32_t *)gxsp_take(&leap->pool, system->mesh.chunk_count, sizeof(uint32_t));
    for (c = 0; c < system->mesh.chunk_count && !leap->pool.failed; c++) {
        leap->first_block[c] = count;
        count += system->mesh.chunks[c].block_count;
    }
    leap->block_count = count;
    leap->blocks = (gxsp_leap_block *)gxsp_take(&leap->pool, count, sizeof *leap->blocks);
    copies = (uint32_t *)gxsp_take(scratch, (size_t)count * GXSP_LANES, 4 * sizeof(uint32_t));
    if (leap->pool.failed || scratch->failed) return NULL;
    for (c = 0; c < system->mesh.chunk_count; c++) {
        const gxsp_chunk *chunk = &system->mesh.chunks[c];
        const double *positions = NULL;
        gxsp_near near;
        gxsp_lanes corners[12], made[9];
        if (!chunk->gradients) positions = gxsp_chunk_load(system, chunk, system->model.positions, near);
        for (b = 0; b < chunk->block_count; b++) {
            gxsp_leap_block *to = &leap->blocks[leap->first_block[c] + b];
            const gxsp_rest *rest = &chunk->rest[b];
            gxsp_lanes *gradients = gxsp_block_gradients(system, chunk, b, positions, corners, made);
            for (lane = 0; lane < GXSP_LANES; lane++) {
                const gxsp_material *material = &system->model.materials[rest->material[lane]];
                const int used = chunk->groups[b * GXSP_LANES + lane] != GXSP_NONE;
                uint32_t *own = copies + 4 * ((size_t)(leap->first_block[c] + b) * GXSP_LANES + lane);
                for (k = 0; k < 9; k++) to->gradient[k][lane] = (float)gradients[k][lane];
                to->mu[lane] = (float)(rest->weight[lane] * material->mu);
                to->lambda[lane] = (float)(rest->weight[lane] * material->lambda);
                if (used) gxsp_lane_copies(system, chunk, b, (int)lane, own);
                if (!used) own[0] = GXSP_NONE;
            }
        }
    }
    return copies;
}

/* Gradient of shape function 0 ... 3 of a lane, k: along an axis */
static float gxsp_leap_gradient(const gxsp_leap_block *block, uint32_t lane, int corner, int k) {
    return corner > 0 ? block->gradient[3 * (corner - 1) + k][lane]
                      : -(block->gradient[k][lane] + block->gradient[3 + k][lane] + block->gradient[6 + k][lane]);
}

/* A row of L: the copies around copy i, and, if entry is not NULL, their numbers, from the lanes in which it is. mark:
 * by copy, i + 1 if its place in the row is at. Returns how many there are. */
static uint32_t gxsp_leap_row(const gxsp_leap *leap, const uint32_t *copies, const uint32_t *corners, uint32_t count,
                              uint32_t i, uint32_t *mark, uint32_t *at, uint32_t *column, float *entry) {
    uint32_t n = 0, c;
    int k, m;
    for (c = 0; c < count; c++) {
        const uint32_t lane = corners[c] / 4;
        const int own = (int)(corners[c] % 4);
        const gxsp_leap_block *block = &leap->blocks[lane / GXSP_LANES];
        const float modulus = gxsp_leap_modulus(block, (int)(lane % GXSP_LANES));
        for (k = 0; k < 4; k++) {
            const uint32_t j = copies[4 * (size_t)lane + (size_t)k];
            if (mark[j] != i + 1) {
                mark[j] = i + 1;
                at[j] = n++;
                if (entry) column[at[j]] = j, entry[at[j]] = 0;
            }
            for (m = 0; m < 3 && entry; m++)
                entry[at[j]] += modulus * gxsp_leap_gradient(block, lane % GXSP_LANES, own, m) *
                                gxsp_leap_gradient(block, lane % GXSP_LANES, k, m);
        }
    }
    return n;
}

/* The order of rows: in each range by length, the longest first */
static void gxsp_leap_order_rows(const gxsp_system *system, const uint32_t *length, uint32_t *order) {
    size_t r, i, end;
    for (r = 0; r < system->model.range_count; r++) {
        uint32_t most = 0, next = 0;
        size_t place, begin;
        end = gxsp_range(system, r, &begin);
        place = begin;
        for (i = begin; i < end; i++) most = length[i] > most ? length[i] : most;
        for (; place < end; most = next, next = 0)
            for (i = begin; i < end; i++) {
                if (length[i] == most) order[place++] = (uint32_t)i;
                if (length[i] < most && length[i] > next) next = length[i];
            }
    }
}

/* L in groups of GXSP_LEAP_ROWS rows, as long as the longest of a group: one loop for all of them. Behind its end a row
 * has zeros and names its own copy. copies: of all lanes */
static void gxsp_leap_rows_make(gxsp_system *system, gxsp_pool *scratch, const uint32_t *copies) {
    gxsp_leap *leap = &system->leap;
    const size_t n = system->model.n, lanes = leap->block_count * GXSP_LANES,
                 groups = (n + GXSP_LEAP_ROWS - 1) / GXSP_LEAP_ROWS;
    uint32_t *first = (uint32_t *)gxsp_take(scratch, n + 2, sizeof(uint32_t));
    uint32_t *corners = (uint32_t *)gxsp_take(scratch, 4 * lanes, sizeof(uint32_t));
    uint32_t *mark = (uint32_t *)gxsp_take(scratch, 2 * n, sizeof(uint32_t));
    uint32_t *length = (uint32_t *)gxsp_take(scratch, n, sizeof(uint32_t)), *columns, longest = 0, k;
    float *entries;
    size_t i;
    leap->start = (uint32_t *)gxsp_take(&leap->pool, groups + 1, sizeof(uint32_t));
    leap->order = (uint32_t *)gxsp_take(&leap->pool, n, sizeof(uint32_t));
    leap->diagonal = (float *)gxsp_take(&leap->pool, n, sizeof(float));
    if (scratch->failed || leap->pool.failed) return;
    for (i = 0; i < 4 * lanes; i++)
        if (copies[i / 4 * 4] != GXSP_NONE) first[copies[i] + 2]++;
    for (i = 2; i < n + 2; i++) first[i] += first[i - 1];
    for (i = 0; i < 4 * lanes; i++)
        if (copies[i / 4 * 4] != GXSP_NONE) corners[first[copies[i] + 1]++] = (uint32_t)i;
    for (i = 0; i < n; i++) {
        length[i] = gxsp_leap_row(leap, copies, corners + first[i], first[i + 1] - first[i], (uint32_t)i, mark,
                                  mark + n, NULL, NULL);
        longest = length[i] > longest ? length[i] : longest;
    }
    gxsp_leap_order_rows(system, length, leap->order);
    for (i = 0; i < n; i += GXSP_LEAP_ROWS)
        leap->start[i / GXSP_LEAP_ROWS + 1] = leap->start[i / GXSP_LEAP_ROWS] + length[leap->order[i]];
    leap->column = (uint32_t *)gxsp_take(&leap->pool, (size_t)leap->start[groups] * GXSP_LEAP_ROWS, sizeof(uint32_t));
    leap->entry = (float *)gxsp_take(&leap->pool, (size_t)leap->start[groups] * GXSP_LEAP_ROWS, sizeof(float));
    columns = (uint32_t *)gxsp_take(scratch, longest, sizeof(uint32_t));
    entries = (float *)gxsp_take(scratch, longest, sizeof(float));
    if (scratch->failed || leap->pool.failed) return;
    memset(mark, 0, n * sizeof *mark);
    for (i = 0; i < n; i++) {
        const size_t group = i / GXSP_LEAP_ROWS, row = i % GXSP_LEAP_ROWS;
        const uint32_t own = leap->order[i];
        gxsp_leap_row(leap, copies, corners + first[own], first[own + 1] - first[own], own, mark, mark + n, columns,
                      entries);
        for (k = 0; k < leap->start[group + 1] - leap->start[group]; k++) {
            const size_t at = (leap->start[group] + k) * (size_t)GXSP_LEAP_ROWS + row;
            leap->column[at] = k < length[own] ? columns[k] : own;
            leap->entry[at] = k < length[own] ? entries[k] : 0;
        }
        if (length[own] > 0) leap->diagonal[own] = entries[mark[n + own]];
    }
}

/* Masses: the lumped ones, but at least bound x the diagonal of L. Light copies would demand short substeps; they get
 * GXSP_LEAP_MASS of the mass of all copies more. So bound is where the sum of what they lack reaches that. */
static void gxsp_leap_masses_make(gxsp_system *system) {
    gxsp_leap *leap = &system->leap;
    const size_t n = system->model.n;
    double all = 0, low = 0, high = 0;
    uint32_t i;
    int k;
    leap->mass = (float *)gxsp_take(&leap->pool, n, sizeof(float));
    leap->inverse = (float *)gxsp_take(&leap->pool, n, sizeof(float));
    if (leap->pool.failed) return;
    for (i = 0; i < n; i++) {
        const double diagonal = system->model.fixed[i] ? 0 : (double)leap->diagonal[i];
        if (!(diagonal > 0)) continue;
        all += system->model.lumped[i];
        high = fmax(high, system->model.lumped[i] / diagonal);
    }
    for (k = 0; k < 40; k++) {
        const double middle = 0.5 * (low + high);
        double lacking = 0;
        for (i = 0; i < n; i++)
            if (!system->model.fixed[i])
                lacking += fmax(0, middle * (double)leap->diagonal[i] - system->model.lumped[i]);
        if (lacking > GXSP_LEAP_MASS * all)
            high = middle;
        else
            low = middle;
    }
    for (i = 0; i < n; i++)
        leap->mass[i] =
            system->model.fixed[i] ? 0 : (float)fmax(system->model.lumped[i], low * (double)leap->diagonal[i]);
}

/* Rows of a group of L times a vector */
GXSP_INLINE void gxsp_leap_group_product(const gxsp_leap *leap, size_t group, const gxsp_vector4 *x,
                                         gxsp_vector4 *sums) {
    const size_t end = leap->start[group + 1];
    size_t k, r;
#if defined(GXSP_SHUFFLES)
    GXSP_FILLED(zero, 0);
    gxsp_four sum[GXSP_LEAP_ROWS];
    for (r = 0; r < GXSP_LEAP_ROWS; r++) sum[r] = zero;
    for (k = leap->start[group]; k < end; k++)
        for (r = 0; r < GXSP_LEAP_ROWS; r++) {
            const float entry = leap->entry[GXSP_LEAP_ROWS * k + r];
            GXSP_FILLED(all, entry);
            sum[r] = GXSP_PLUS(sum[r], GXSP_TIMES(all, GXSP_LOAD(x[leap->column[GXSP_LEAP_ROWS * k + r]])));
        }
    for (r = 0; r < GXSP_LEAP_ROWS; r++) GXSP_STORE(sums[r], sum[r]);
#else
    int c;
    memset(sums, 0, GXSP_LEAP_ROWS * sizeof *sums); /* the fourth number too */
    for (k = leap->start[group]; k < end; k++)
        for (r = 0; r < GXSP_LEAP_ROWS; r++)
            for (c = 0; c < 3; c++)
                sums[r][c] += leap->entry[GXSP_LEAP_ROWS * k + r] * x[leap->column[GXSP_LEAP_ROWS * k + r]][c];
#endif
}

/* The largest eigenvalue of M^-1 L by the power method, from vectors that no symmetry of a mesh leaves out. It is
 * reached from below: the factor on L covers the rest. */
static void gxsp_leap_find_top(gxsp_system *system) {
    gxsp_leap *leap = &system->leap;
    gxsp_vector4 sums[GXSP_LEAP_ROWS];
    uint32_t seed = 1;
    size_t i;
    int k, c;
    for (i = 0; i < system->model.n; i++)
        for (c = 0; c < 3; c++) {
            seed = seed * 1664525u + 1013904223u;
            leap->last[i][c] = leap->mass[i] > 0 ? (float)(seed >> 8) / 8388608.0f - 1 : 0;
        }
    for (k = 0; k < GXSP_LEAP_POWERS; k++) {
        double before = 0, after = 0;
        float scale;
        for (i = 0; i < system->model.n; i++) {
            const uint32_t own = leap->order[i];
            const float mass = leap->mass[own], *from = leap->last[own];
            float *to = leap->next[own];
            if (i % GXSP_LEAP_ROWS == 0)
                gxsp_leap_group_product(leap, i / GXSP_LEAP_ROWS, (const gxsp_vector4 *)leap->last, sums);
            for (c = 0; c < 3; c++) {
                to[c] = mass > 0 ? sums[i % GXSP_LEAP_ROWS][c] / mass : 0;
                before += (double)mass * (double)from[c] * (double)from[c];
                after += (double)mass * (double)to[c] * (double)to[c];
            }
        }
        leap->top = before > 0 ? sqrt(after / before) : 0;
        scale = leap->top > 0 ? (float)(1 / leap->top) : 0;
        for (i = 0; i < system->model.n; i++)
            for (c = 0; c < 3; c++) leap->last[i][c] = scale * leap->next[i][c];
    }
}

/* L, masses and vectors: what explicit steps need besides blocks. copies: of all lanes */
static void gxsp_leap_rest_make(gxsp_system *system, gxsp_pool *scratch, const uint32_t *copies) {
    gxsp_leap *leap = &system->leap;
    gxsp_vector4 **vectors[4];
    int k;
    gxsp_leap_rows_make(system, scratch, copies);
    if (!scratch->failed && !leap->pool.failed) gxsp_leap_masses_make(system);
    vectors[0] = &leap->start_of_filter, vectors[1] = &leap->last, vectors[2] = &leap->before, vectors[3] = &leap->next;
    for (k = 0; k < 4; k++) *vectors[k] = (gxsp_vector4 *)gxsp_take(&leap->pool, system->model.n, sizeof(gxsp_vector4));
    leap->stiffest = (float *)gxsp_take(&leap->pool, system->mesh.chunk_count, sizeof(float));
}

/* All that explicit steps need of the model (GXSP_LEAP_ALL), or quick ones. Returns 0 if there is no memory. */
static int gxsp_leap_make(gxsp_system *system, int all) {
    gxsp_leap *leap = &system->leap;
    gxsp_pool scratch = gxsp_pool_make(&system->pool.allocator);
    const uint32_t *copies;
    if (leap->made >= all) return 1;
    gxsp_release_to(&leap->pool, NULL);
    memset(leap, 0, sizeof *leap);
    leap->pool = gxsp_pool_make(&system->pool.allocator);
    leap->suits = gxsp_leap_suits(system);
    leap->made = all;
    if (!leap->suits) return 1;
    copies = gxsp_leap_blocks_make(system, &scratch);
    if (copies && all == GXSP_LEAP_ALL) gxsp_leap_rest_make(system, &scratch, copies);
    if (!copies || scratch.failed || leap->pool.failed) {
        gxsp_release_to(&scratch, NULL);
        gxsp_release_to(&leap->pool, NULL);
        memset(leap, 0, sizeof *leap);
        return 0;
    }
    gxsp_release_to(&scratch, NULL);
    if (all == GXSP_LEAP_ALL) gxsp_leap_find_top(system);
    return 1;
}

/* Accelerations, before the filter: gravity, nodal forces and elastic ones over the mass; 0 where nothing moves */
static void gxsp_task_leap_sum(void *context, size_t index) {
    const gxsp_pass *pass = (const gxsp_pass *)context;
    const gxsp_system *system = pass->system;
    const gxs_step_desc *step = pass->problem->step;
    gxsp_vector4 *slots = (gxsp_vector4 *)(void *)system->vectors.slots;
    size_t i, end = gxsp_range(system, index, &i);
    int c;
    for (; i < end; i++) {
        const float inverse = system->leap.inverse[i];
        float sum[3] = {0, 0, 0};
        uint32_t s;
        for (s = system->mesh.copy_start[i]; s < system->mesh.copy_start[i + 1]; s++) {
            const float *from = slots[system->mesh.copy_slot[s]];
            gxsp_prefetch(slots[system->mesh.copy_slot[s + GXSP_AHEAD]], sizeof *slots);
            sum[0] += from[0], sum[1] += from[1], sum[2] += from[2];
        }
        for (c = 0; c < 3; c++) {
            const float force = (step->forces ? (float)step->forces[3 * i + (size_t)c] : 0) - sum[c];
            system->leap.start_of_filter[i][c] = inverse > 0 ? inverse * force + (float)step->gravity[c] : 0;
        }
    }
}

/* The next of Chebyshev's recurrence for (1 - T_k(y)) / (1 - y) times the accelerations z, y = 1 - factor M^-1 L:
 * q_k+1 = 2 y q_k - q_k-1 + 2 z */
static void gxsp_task_leap_filter(void *context, size_t index) {
    const gxsp_pass *pass = (const gxsp_pass *)context;
    const gxsp_leap *leap = &pass->system->leap;
    size_t i, r, end = gxsp_range(pass->system, index, &i);
    gxsp_vector4 sums[GXSP_LEAP_ROWS];
    int c;
    for (; i < end; i += GXSP_LEAP_ROWS) {
        gxsp_leap_group_product(leap, i / GXSP_LEAP_ROWS, (const gxsp_vector4 *)leap->last, sums);
        for (r = 0; r < GXSP_LEAP_ROWS && i + r < end; r++) {
            const uint32_t own = leap->order[i + r];
            const float scale = (float)pass->factor * leap->inverse[own], *last = leap->last[own],
                        *z = leap->start_of_filter[own], *before = leap->before[own];
            float *next = leap->next[own];
            for (c = 0; c < 4; c++) next[c] = 2 * (last[c] - scale * sums[r][c] + z[c]) - before[c];
        }
    }
}

/* v changes by a substep's acceleration, last x factor, and by damping; u moves by h v, or by h/2 v in the last
 * substep (pass->exact). pass->rate: h; sum: v; direction: u */
static void gxsp_task_leap_move(void *context, size_t index) {
    const gxsp_pass *pass = (const gxsp_pass *)context;
    gxsp_system *system = pass->system;
    const double h = pass->rate, damping = 0.5 * h * pass->problem->step->mass_damping,
                 keep = (1 - damping) / (1 + damping), push = h * pass->factor / (1 + damping),
                 move = pass->exact ? 0.5 * h : h;
    size_t i, end = gxsp_range(system, index, &i), c;
    for (; i < end; i++)
        for (c = 3 * i; c < 3 * i + 3 && system->leap.inverse[i] > 0; c++) {
            pass->sum[c] = keep * pass->sum[c] + push * (double)system->leap.last[i][c - 3 * i];
            system->vectors.direction[c] += move * pass->sum[c];
        }
}

/* The degree of the filter for a substep at this factor on L; 0: more than GXSP_LEAP_DEGREES */
static uint32_t gxsp_leap_degree(const gxsp_leap *leap, double h, double factor) {
    const double degree = ceil(0.5 * h * sqrt(factor * leap->top));
    return degree <= 1 ? 1 : degree <= GXSP_LEAP_DEGREES ? (uint32_t)degree : 0;
}

/* Filters the accelerations; last x the result: those of the substep. */
static double gxsp_leap_filter(gxsp_problem *problem, gxsp_pass *pass, double h, double factor, uint32_t degree) {
    gxsp_leap *leap = &problem->system->leap;
    uint32_t k;
    memcpy(leap->last, leap->start_of_filter, problem->system->model.n * sizeof *leap->last);
    if (degree > 1) memset(leap->before, 0, problem->system->model.n * sizeof *leap->before);
    pass->factor = h * h * factor / (2.0 * degree * degree);
    for (k = 1; k < degree; k++) {
        gxsp_vector4 *oldest = leap->before;
        gxsp_over_ranges(problem->system, gxsp_task_leap_filter, pass, NULL, 0);
        leap->before = leap->last;
        leap->last = leap->next;
        leap->next = oldest;
    }
    return 1.0 / ((double)degree * degree);
}

/* A substep from the middle of its way, direction: forces, filter, and all of the way that is left to the middle of the
 * next substep, or to the end. Returns 0 if the filter would be too long: an element is stretched far. */
static int gxsp_leap_substep(gxsp_problem *problem, double h, int last, double *velocity) {
    gxsp_system *system = problem->system;
    double stiffest = 1, factor;
    uint32_t degree, c;
    gxsp_pass pass;
    memset(&pass, 0, sizeof pass);
    pass.system = system;
    pass.problem = problem;
    pass.from = system->vectors.direction;
    pass.sum = velocity;
    gxsp_parallel(system->jobs, system->mesh.chunk_count, gxsp_task_leap_force, &pass);
    for (c = 0; c < system->mesh.chunk_count; c++)
        stiffest = (double)system->leap.stiffest[c] > stiffest ? (double)system->leap.stiffest[c] : stiffest;
    factor = system->leap.factor * stiffest;
    degree = gxsp_leap_degree(&system->leap, h, factor);
    if (degree == 0) return 0;
    gxsp_over_ranges(system, gxsp_task_leap_sum, &pass, NULL, 0);
    pass.factor = gxsp_leap_filter(problem, &pass, h, factor, degree);
    pass.rate = h;
    pass.exact = last;
    gxsp_over_ranges(system, gxsp_task_leap_move, &pass, NULL, 0);
    return 1;
}

/* Elastic, kinetic and potential energy with the masses of explicit steps, J; elastic: known. *size: elastic and
 * kinetic energy, that of the mean velocity by a tenth */
static double gxsp_leap_energy(const gxsp_problem *problem, double elastic, const double *u, const double *v,
                               double *size) {
    const gxsp_system *system = problem->system;
    const gxs_step_desc *step = problem->step;
    double kinetic = 0, work = 0, all = 0, momentum[3] = {0, 0, 0};
    size_t i, c;
    for (i = 0; i < system->model.n; i++) {
        const double mass = system->leap.inverse[i] > 0 ? (double)system->leap.mass[i] : 0;
        all += mass;
        for (c = 0; c < 3 && mass > 0; c++) {
            kinetic += 0.5 * mass * v[3 * i + c] * v[3 * i + c];
            momentum[c] += mass * v[3 * i + c];
            work += (mass * step->gravity[c] + (step->forces ? step->forces[3 * i + c] : 0)) * u[3 * i + c];
        }
    }
    *size = elastic + kinetic - (all > 0 ? 0.5 * gxsp_dot(momentum, momentum, 1) / all : 0);
    *size = fmax(*size, 0) + 0.1 * kinetic;
    return elastic + kinetic - work;
}

/* Sum of the components' elastic energies at a displacement, from the state that the last step returned if that is it
 */
static double gxsp_leap_elastic(gxsp_problem *problem, const double *u, int known) {
    gxsp_system *system = problem->system;
    double sum = 0;
    uint32_t p;
    if (!known) gxsp_evaluate_elements(system, 0, u, NULL, 0, system->vectors.force);
    for (p = 0; p < system->model.component_count; p++)
        sum += known ? system->model.components[p].base_energy : system->model.components[p].energies[0];
    return sum;
}

/* Substeps of a step: as asked, or as few as a filter of GXSP_LEAP_DEGREE serves at rest; 0: more than
 * GXSP_LEAP_SUBSTEPS. */
static uint32_t gxsp_leap_count(const gxsp_problem *problem) {
    const gxs_step_desc *step = problem->step;
    const double own =
        step->dt * 0.5 * sqrt(problem->system->leap.factor * problem->system->leap.top) / GXSP_LEAP_DEGREE;
    if (step->substeps > 0) return step->substeps;
    return own <= GXSP_LEAP_SUBSTEPS ? (uint32_t)fmax(1, ceil(own)) : 0;
}

/* Can this step be explicit? Nothing but gravity, nodal forces and mass damping acts. */
static int gxsp_leap_allowed(const gxsp_problem *problem) {
    const gxs_step_desc *step = problem->step;
    return step->integrator == GXS_EXPLICIT && problem->system->leap.suits && !step->targets &&
           gxsp_point_count(step) == 0 && problem->system->state.active > 0 && 0.5 * step->dt * step->mass_damping < 1;
}

/* The explicit step: displacement into direction, velocity into residual. h: of a substep. Returns 0 if an element is
 * stretched too far or a number is not finite. */
static int gxsp_leap_try(gxsp_problem *problem, uint32_t substeps, const double *displacement, const double *velocity) {
    const gxsp_system *system = problem->system;
    const size_t count = 3 * system->model.n;
    const double h = problem->step->dt / substeps;
    double *u = system->vectors.direction, *v = system->vectors.residual;
    uint32_t s;
    size_t i;
    for (i = 0; i < count; i++) {
        v[i] = system->leap.inverse[i / 3] > 0 ? velocity[i] : 0;
        u[i] = displacement[i] + 0.5 * h * v[i];
    }
    for (s = 0; s < substeps; s++)
        if (!gxsp_leap_substep(problem, h, s + 1 == substeps, v)) return 0;
    return gxsp_first_not_finite(u, count) == count && gxsp_first_not_finite(v, count) == count;
}

/* Tries the step, and again with a larger factor on L as long as energy is above its limit. The energy measured lacks
 * what the filter adds to the inertia, so it rises and falls; above its limit it was created. Returns 0 where the step
 * must be implicit, which damps. */
static int gxsp_leap_step(gxsp_problem *problem, const double *displacement, const double *velocity) {
    gxsp_system *system = problem->system;
    gxsp_leap *leap = &system->leap;
    const double *u = system->vectors.direction, *v = system->vectors.residual;
    const int known =
        system->state.base_known && memcmp(displacement, system->vectors.current, 3 * system->model.n * sizeof *u) == 0;
    double energies[2] = {0, 0}, size, before, after, limit;
    uint32_t p, substeps;
    size_t i;
    gxsp_choose_leads(problem);
    for (i = 0; i < system->model.n; i++)
        leap->inverse[i] = system->state.still[i] || !(leap->mass[i] > 0) ? 0 : 1 / leap->mass[i];
    before = gxsp_leap_energy(problem, gxsp_leap_elastic(problem, displacement, known), displacement, velocity, &size);
    limit = leap->limited && known ? fmax(leap->limit, before) : before;
    leap->limited = 0;
    for (;; leap->factor *= GXSP_LEAP_RAISE) {
        if (!(leap->factor > 0)) leap->factor = GXSP_LEAP_FACTOR;
        if ((substeps = gxsp_leap_count(problem)) == 0) return 0;
        if (gxsp_leap_try(problem, substeps, displacement, velocity)) {
            energies[0] = gxsp_leap_elastic(problem, u, 0);
            after = gxsp_leap_energy(problem, energies[0], u, v, &size);
            if (gxsp_finite(after) && after <= limit + GXSP_LEAP_GAIN * size) break;
        }
        if (leap->factor >= GXSP_LEAP_LAST) return 0;
    }
    leap->limit = fmax(after, limit + GXSP_LEAP_FORGET * (after - limit));
    leap->limited = 1;
    for (p = 0; p < system->model.component_count; p++)
        system->model.components[p].before[0] = system->model.components[p].energies[0];
    problem->report.substeps = substeps;
    problem->report.stop = GXS_STOP_ITERATIONS;
    problem->report.energy = gxsp_potential(problem, energies, u);
    system->state.guess_count = 0;
    return 1;
}

/* >>quick: steps of a few iterations ------------------------------------------------------------------------------- */

/* In: the step and the state at its start. Out: the state at its end in direction and residual, or nothing where the
 * step must be a usual one.
 *
 * Backward Euler, BDF2 and the midpoint rule by one linear solve of a few iterations from where inertia leads. Forces
 * and the exact Hessian there come from one pass in single precision (>>strains). The preconditioner is that of
 * earlier steps: its diagonal and coarse matrices age, the Hessian does not. No line search: energies of components at
 * the end are compared with those at the start. One that has gained is slowed down; one that gains more than a share
 * of its kinetic energy has left the linear model. The midpoint rule then ends nearer to the middle of its step, where
 * energy is that of backward Euler; if that is too high as well, the step is not quick. */

/* Memory for quick steps. Returns 0 if there is none. */
static int gxsp_quick_make(gxsp_system *system) {
    gxsp_leap *leap = &system->leap;
    if (!gxsp_leap_make(system, GXSP_LEAP_BLOCKS)) return 0;
    if (leap->suits && !leap->strains)
        leap->strains = (gxsp_strain *)gxsp_take(&leap->pool, leap->block_count, sizeof *leap->strains);
    leap->pool.failed = 0;
    return !leap->suits || leap->strains;
}

/* Do body and loads allow quick steps? */
static int gxsp_quick_suits(const gxsp_system *system, const gxs_step_desc *step) {
    return gxsp_leap_suits(system) && !system->multigrid.fine && !system->model.volume && !step->targets &&
           gxsp_point_count(step) == 0;
}

/* Can this step be quick? */
static int gxsp_quick_allowed(const gxsp_problem *problem) {
    const gxs_step_desc *step = problem->step;
    return step->quick > 0 && step->integrator <= GXS_MIDPOINT && problem->system->state.active > 0 &&
           gxsp_quick_suits(problem->system, step);
}

/* residual = load - inertia - elastic forces, from the slots; 0 where nothing moves */
static void gxsp_task_quick_balance(void *context, size_t index) {
    const gxsp_pass *pass = (const gxsp_pass *)context;
    const gxsp_system *system = pass->system;
    gxsp_vector4 *slots = (gxsp_vector4 *)(void *)system->vectors.slots;
    size_t i, end = gxsp_range(system, index, &i), c;
    for (; i < end; i++) {
        double load[3], inertia = pass->rate * system->model.lumped[i];
        float sum[3] = {0, 0, 0};
        uint32_t s;
        for (s = system->mesh.copy_start[i]; s < system->mesh.copy_start[i + 1]; s++) {
            const float *from = slots[system->mesh.copy_slot[s]];
            gxsp_prefetch(slots[system->mesh.copy_slot[s + GXSP_AHEAD]], sizeof *slots);
            sum[0] += from[0], sum[1] += from[1], sum[2] += from[2];
        }
        gxsp_load(pass->problem, i, load);
        for (c = 0; c < 3; c++)
            system->vectors.residual[3 * i + c] =
                system->state.still[i]
                    ? 0
                    : load[c] - (double)sum[c] - inertia * (pass->from[3 * i + c] - system->vectors.target[3 * i + c]);
    }
}

/* Elastic energies of all components at a displacement into their gain, J */
static void gxsp_quick_elastic(gxsp_system *system, const double *from) {
    gxsp_pass pass;
    uint32_t p;
    memset(&pass, 0, sizeof pass);
    pass.system = system;
    pass.from = from;
    gxsp_parallel(system->jobs, system->mesh.chunk_count, gxsp_task_strain_energy, &pass);
    for (p = 0; p < system->model.component_count; p++) system->model.components[p].gain = 0;
    for (p = 0; p < system->mesh.partial_count; p++)
        system->model.components[system->mesh.partials[p].component].gain += system->mesh.partials[p].energies[0];
}

/* Of all components: momentum / mass into sum, kinetic energy about that into low, gain += kinetic energy minus the
 * work of the load, and the size of what rounds into rounding. A held component has no mean. */
static void gxsp_quick_kinetic(const gxsp_problem *problem, const double *u, const double *v) {
    gxsp_system *system = problem->system;
    uint32_t p;
    size_t i;
    gxsp_clear_components(system);
    for (p = 0; p < system->model.component_count; p++)
        system->model.components[p].low = system->model.components[p].rounding = 0;
    for (i = 0; i < system->model.n; i++) {
        gxsp_component *component = &system->model.components[system->model.component[i]];
        const double mass = system->state.still[i] ? 0 : system->model.lumped[i], *speed = v + 3 * i;
        double load[3], kinetic, work;
        gxsp_load(problem, i, load);
        gxsp_add_to_component(system, i, mass * speed[0], mass * speed[1], mass * speed[2]);
        kinetic = 0.5 * mass * gxsp_dot(speed, speed, 1);
        work = gxsp_dot(load, u + 3 * i, 1);
        component->low += kinetic;
        component->gain -= work;
        component->rounding += kinetic + fabs(work);
    }
    gxsp_average_components(system, 0);
    for (p = 0; p < system->model.component_count; p++) {
        gxsp_component *component = &system->model.components[p];
        component->gain += component->low;
        component->low -= 0.5 * component->mass * gxsp_dot(component->sum, component->sum, 1);
    }
}

/* Energies at the start into the components' limit, with what they were below it before */
static void gxsp_quick_limit(const gxsp_problem *problem, const double *displacement, const double *velocity) {
    gxsp_system *system = problem->system;
    const int known = system->leap.known &&
                      memcmp(displacement, system->vectors.current, 3 * system->model.n * sizeof *displacement) == 0;
    uint32_t p;
    if (!known) gxsp_quick_elastic(system, displacement);
    for (p = 0; p < system->model.component_count && known; p++)
        system->model.components[p].gain = system->model.components[p].elastic;
    gxsp_quick_kinetic(problem, displacement, velocity);
    for (p = 0; p < system->model.component_count; p++) {
        gxsp_component *component = &system->model.components[p];
        component->limit = component->gain + (known ? component->slack : 0);
    }
}

/* The solve: current from where inertia leads. 0: a number is not finite, or the exact Hessian is indefinite at once.
 */
static int gxsp_quick_solve(gxsp_problem *problem) {
    gxsp_system *system = problem->system;
    gxsp_pass pass;
    size_t i;
    gxsp_find_base(problem, system->vectors.current);
    for (i = 0; i < system->model.n; i++)
        if (!system->state.still[i])
            memcpy(system->vectors.current + 3 * i, system->vectors.target + 3 * i, 3 * sizeof(double));
    gxsp_untouch_components(system);
    gxsp_terms_make(problem, system->vectors.current);
    gxsp_balance_momentum(problem, 0, NULL, system->vectors.current);
    if (gxsp_first_not_finite(system->vectors.current, 3 * system->model.n) < 3 * system->model.n) return 0;
    if (system->leap.served == 0 || system->leap.served >= GXSP_QUICK_AGE ||
        (system->multigrid.used && (system->coarse.worn || gxsp_coarse_ends(system) ||
                                    system->coarse.rate < problem->rate || system->coarse.rate > problem->rate))) {
        if (!gxsp_linearise_all(problem) || problem->collapsed) return 0;
        system->leap.served = 0;
    }
    system->leap.served++;
    memset(&pass, 0, sizeof pass);
    pass.system = system;
    pass.problem = problem;
    pass.from = system->vectors.current;
    pass.rate = problem->rate;
    gxsp_parallel(system->jobs, system->mesh.chunk_count, gxsp_task_strain_force, &pass);
    gxsp_over_ranges(system, gxsp_task_quick_balance, &pass, NULL, 0);
    system->state.guess_count = 0;
    if (!gxsp_solve(problem)) return 0;
    system->state.guess_count = 0;
    for (i = 0; i < 3 * system->model.n; i++) system->vectors.current[i] += system->vectors.direction[i];
    return 1;
}

/* Slows components down whose energy at the end is above their limit. 0: one has gained too much; its second half is to
 * be half as long, or none with `last`. */
static int gxsp_quick_settle(gxsp_problem *problem, int last, const double *u, double *v) {
    gxsp_system *system = problem->system;
    size_t i, c;
    uint32_t p;
    int any = 0, settled = 1;
    gxsp_quick_elastic(system, u);
    for (p = 0; p < system->model.component_count; p++)
        system->model.components[p].elastic = system->model.components[p].gain;
    gxsp_quick_kinetic(problem, u, v);
    for (p = 0; p < system->model.component_count; p++) {
        gxsp_component *component = &system->model.components[p];
        const double risen = component->gain - component->limit,
                     unsure = 1e-12 * component->rounding + 1e-6 * component->elastic;
        component->length = 1;
        component->slack = risen < 0 ? -(1 - GXSP_LEAP_FORGET) * risen : -risen;
        if (!gxsp_finite(risen)) return 0;
        if (risen <= unsure) continue;
        component->slack = 0;
        if (risen > GXSP_QUICK_CUT * component->low) {
            component->reach *= last ? 0 : 0.5;
            settled = 0;
            continue;
        }
        component->length = sqrt(1 - risen / component->low);
        any = 1;
    }
    for (i = 0; i < system->model.n && any && settled; i++) {
        const gxsp_component *component = &system->model.components[system->model.component[i]];
        for (c = 0; c < 3 && !system->state.still[i]; c++)
            v[3 * i + c] = component->sum[c] + component->length * (v[3 * i + c] - component->sum[c]);
    }
    return settled;
}

/* Energy of all components at the end, J */
static double gxsp_quick_total(const gxsp_system *system) {
    double sum = 0;
    uint32_t p;
    for (p = 0; p < system->model.component_count; p++)
        sum += fmin(system->model.components[p].gain, system->model.components[p].limit);
    return sum;
}

/* x += what each component goes of its way from a to b in the midpoint rule's second half: its reach, but all of the
 * mean if it is loose. x may be b. */
static void gxsp_quick_add_way(gxsp_system *system, const double *a, const double *b, double *x) {
    size_t i, c;
    gxsp_clear_components(system);
    for (i = 0; i < system->model.n; i++) {
        const double mass = system->state.still[i] ? 0 : system->model.lumped[i], *from = a + 3 * i, *to = b + 3 * i;
        gxsp_add_to_component(system, i, mass * (to[0] - from[0]), mass * (to[1] - from[1]), mass * (to[2] - from[2]));
    }
    gxsp_average_components(system, 0);
    for (i = 0; i < system->model.n; i++) {
        const gxsp_component *component = &system->model.components[system->model.component[i]];
        for (c = 0; c < 3 && !system->state.still[i]; c++) {
            const double way = b[3 * i + c] - a[3 * i + c];
            x[3 * i + c] += way - (1 - component->reach) * (way - component->sum[c]);
        }
    }
}

/* The end of the step from current: displacement into direction, velocity into residual */
static void gxsp_quick_end(const gxsp_problem *problem, const double *displacement, const double *velocity) {
    gxsp_system *system = problem->system;
    double *ends = system->vectors.direction, *speeds = system->vectors.residual;
    size_t i;
    for (i = 0; i < 3 * system->model.n; i++) {
        ends[i] = system->state.still[i / 3] ? displacement[i] : system->vectors.current[i];
        speeds[i] = system->state.still[i / 3] ? 0 : problem->speed * (ends[i] - gxsp_mean(problem, displacement, i));
    }
    if (problem->step->integrator != GXS_MIDPOINT) return;
    gxsp_quick_add_way(system, displacement, system->vectors.current, ends);
    gxsp_quick_add_way(system, velocity, speeds, speeds);
}

/* The quick step: displacement into direction, velocity into residual. Returns 0 where the step must be a usual one. */
static int gxsp_quick_step(gxsp_problem *problem, const double *displacement, const double *velocity) {
    gxsp_system *system = problem->system;
    const int trials = problem->step->integrator == GXS_MIDPOINT ? GXSP_QUICK_TRIALS : 1;
    uint32_t p;
    int solved, done = 0, trial;
    system->state.quick = 1;
    gxsp_choose_leads(problem);
    gxsp_quick_limit(problem, displacement, velocity);
    gxsp_begin(problem, velocity);
    problem->cg_iterations = problem->step->quick;
    solved = gxsp_quick_solve(problem);
    for (p = 0; p < system->model.component_count; p++) system->model.components[p].reach = 1;
    for (trial = 1; trial <= trials && solved && !done; trial++) {
        gxsp_quick_end(problem, displacement, velocity);
        done = gxsp_quick_settle(problem, trial + 1 >= trials, system->vectors.direction, system->vectors.residual);
    }
    system->state.quick = 0;
    if (!done) {
        problem->cg_tolerance = fmin(problem->cg_tolerance, GXSP_QUICK_RETRY);
        problem->cg_iterations = problem->step->cg_iterations ? problem->step->cg_iterations : 1000;
        problem->report.stop = GXS_STOP_BALANCE;
        return 0;
    }
    if (problem->report.stop != GXS_STOP_SECONDS) problem->report.stop = GXS_STOP_ITERATIONS;
    problem->report.energy = gxsp_quick_total(system);
    problem->report.quick = 1;
    return 1;
}

/* >>check: of what is given ---------------------------------------------------------------------------------------- */

/* In: what the caller gives. Out: a result code, and the index of what is wrong. Nothing is written but the
 * failure and, by gxsp_check_free, marks of touched components. */

static GXSP_COLD gx_result gxsp_refuse(gx_failure *failure, const char *field) {
    return gxsp_fail(failure, GX_ERROR_ARGUMENT, field, SIZE_MAX);
}

/* A number that must be finite and 0 or more */
static gx_result gxsp_check_size(double number, const char *field, size_t index, gx_failure *failure) {
    if (!gxsp_finite(number)) return gxsp_fail(failure, GX_ERROR_NOT_FINITE, field, index);
    return number < 0 ? gxsp_fail(failure, GX_ERROR_ARGUMENT, field, index) : GX_OK;
}

static gx_result gxsp_check_finite(const double *numbers, size_t count, const char *field, size_t index,
                                   gx_failure *failure) {
    return gxsp_first_not_finite(numbers, count) < count ? gxsp_fail(failure, GX_ERROR_NOT_FINITE, field, index)
                                                         : GX_OK;
}

static gx_result gxsp_check_element(const gxs_element *element, const gxs_model *model, size_t index,
                                    gx_failure *failure) {
    int i;
    for (i = 0; i < 4; i++)
        if (element->copy[i] >= model->copy_count) return gxsp_fail(failure, GX_ERROR_INDEX, "elements.copy", index);
    if (element->material >= model->material_count)
        return gxsp_fail(failure, GX_ERROR_INDEX, "elements.material", index);
    if (gxsp_first_not_finite(&element->gradient[1][0], 9) < 9)
        return gxsp_fail(failure, GX_ERROR_NOT_FINITE, "elements.gradient", index);
    if (!gxsp_finite(element->weight)) return gxsp_fail(failure, GX_ERROR_NOT_FINITE, "elements.weight", index);
    if (gxsp_first_not_finite(element->mass, 10) < 10)
        return gxsp_fail(failure, GX_ERROR_NOT_FINITE, "elements.mass", index);
    if (element->weight < 0) return gxsp_fail(failure, GX_ERROR_INVERTED, "elements.weight", index);
    if (element->mass[0] < 0 || element->mass[4] < 0 || element->mass[7] < 0 || element->mass[9] < 0)
        return gxsp_fail(failure, GX_ERROR_ARGUMENT, "elements.mass", index);
    return GX_OK;
}

static gx_result gxsp_check_material(const gxs_material *material, size_t index, gx_failure *failure) {
    gx_result result;
    if ((int)material->kind < 0 || material->kind > GXS_CUSTOM)
        return gxsp_fail(failure, GX_ERROR_ARGUMENT, "materials.kind", index);
    if ((result = gxsp_check_size(material->young, "materials.young", index, failure)) != GX_OK ||
        (result = gxsp_check_size(material->poisson, "materials.poisson", index, failure)) != GX_OK ||
        (result = gxsp_check_size(material->damping, "materials.damping", index, failure)) != GX_OK)
        return result;
    if (!(material->young > 0)) return gxsp_fail(failure, GX_ERROR_ARGUMENT, "materials.young", index);
    if (material->poisson >= 0.5) return gxsp_fail(failure, GX_ERROR_ARGUMENT, "materials.poisson", index);
    if (material->kind == GXS_CUSTOM && !material->energy)
        return gxsp_fail(failure, GX_ERROR_ARGUMENT, "materials.energy", index);
    return GX_OK;
}

static gx_result gxsp_check_vector(const double *vector, size_t copy_count, const char *field, gx_failure *failure) {
    size_t i;
    if (!vector) return gxsp_refuse(failure, field);
    i = gxsp_first_not_finite(vector, 3 * copy_count);
    return i < 3 * copy_count ? gxsp_fail(failure, GX_ERROR_NOT_FINITE, field, i / 3) : GX_OK;
}

static gx_result gxsp_check_constraint(const gxs_constraint *constraint, size_t n, size_t index, gx_failure *failure) {
    int k;
    if (constraint->copy >= n) return gxsp_fail(failure, GX_ERROR_INDEX, "constraints.copy", index);
    for (k = 0; k < 4; k++) {
        if (constraint->master[k] >= n) return gxsp_fail(failure, GX_ERROR_INDEX, "constraints.master", index);
        if (!gxsp_finite(constraint->weight[k]))
            return gxsp_fail(failure, GX_ERROR_NOT_FINITE, "constraints.weight", index);
    }
    return GX_OK;
}

/* An array that is there, unless it has no items */
static gx_result gxsp_check_array(const void *array, size_t count, const char *field, gx_failure *failure) {
    return array || count == 0 ? GX_OK : gxsp_refuse(failure, field);
}

/* The size of an array that may not be empty. No array takes more than 1024 bytes per object, so that sizes cannot
 * overflow. */
static gx_result gxsp_check_count(size_t count, size_t limit, const char *field, gx_failure *failure) {
    if (count == 0) return gxsp_fail(failure, GX_ERROR_EMPTY, field, SIZE_MAX);
    return count >= limit || count >= SIZE_MAX / 1024 ? gxsp_fail(failure, GX_ERROR_LIMIT, field, SIZE_MAX) : GX_OK;
}

/* Affine copies and their hidden vectors. owned: copy_count zeros, scratch: hidden 1, affine 2 */
static gx_result gxsp_check_affine(const gxs_model *model, const gxs_solver *solver, uint8_t *owned,
                                   gx_failure *failure) {
    size_t i, k, any = 0;
    for (i = 0; i < model->copy_count; i++) {
        const uint32_t first = model->affine[i];
        if (first == GXS_NOT_AFFINE) continue;
        if (first >= model->copy_count || model->copy_count - first < 3)
            return gxsp_fail(failure, GX_ERROR_INDEX, "affine", i);
        for (any = k = 1; k < 4; k++) {
            const size_t vector = (size_t)first + k - 1;
            if (owned[vector]) return gxsp_fail(failure, GX_ERROR_ARGUMENT, "affine", i);
            owned[vector] = 1;
            if (model->held && !model->held[vector] != !model->held[i])
                return gxsp_fail(failure, GX_ERROR_ARGUMENT, "held", vector);
        }
    }
    if (!any) return GX_OK;
    for (i = 0; i < model->copy_count; i++) {
        if (model->affine[i] == GXS_NOT_AFFINE) continue;
        if (owned[i]) return gxsp_fail(failure, GX_ERROR_ARGUMENT, "affine", i);
        owned[i] = 2;
    }
    if (!gxsp_finite(model->affine_length)) return gxsp_fail(failure, GX_ERROR_NOT_FINITE, "affine_length", SIZE_MAX);
    if (!(model->affine_length > 0)) return gxsp_fail(failure, GX_ERROR_ARGUMENT, "affine_length", SIZE_MAX);
    if (model->lumped_mass) return gxsp_refuse(failure, "lumped_mass");
    if (solver->matrix == GXS_MATRIX_ASSEMBLED) return gxsp_refuse(failure, "matrix");
    if (solver->preconditioner == GXS_VOLUME_RATIO) return gxsp_refuse(failure, "preconditioner");
    for (i = 0; i < model->constraint_count; i++)
        for (k = 0; k < 5; k++) {
            const uint8_t kind = owned[k < 4 ? model->constraints[i].master[k] : model->constraints[i].copy];
            if (kind == 1 || (kind == 2 && k == 4 && !model->positions))
                return gxsp_fail(failure, GX_ERROR_ARGUMENT, kind == 1 ? "constraints" : "positions", i);
        }
    for (i = 0; i < model->element_count; i++) {
        double edge[3][3];
        for (k = 0; k < 4; k++)
            if (owned[model->elements[i].copy[k]] == 1)
                return gxsp_fail(failure, GX_ERROR_ARGUMENT, "elements.copy", i);
        if (model->elements[i].weight > 0 && gxsp_is_affine(model, &model->elements[i]) &&
            !gxsp_element_edges(&model->elements[i], edge))
            return gxsp_fail(failure, GX_ERROR_FLAT, "elements.gradient", i);
    }
    return GX_OK;
}

static gx_result gxsp_check_model(const gxs_model *model, gx_failure *failure) {
    size_t e;
    gx_result result;
    if (!model) return gxsp_refuse(failure, "model");
    /* an element has at most four slots */
    if ((result = gxsp_check_array(model->elements, model->element_count, "elements", failure)) != GX_OK ||
        (result = gxsp_check_array(model->constraints, model->constraint_count, "constraints", failure)) != GX_OK ||
        (result = gxsp_check_array(model->materials, model->material_count, "materials", failure)) != GX_OK ||
        (result = gxsp_check_count(model->copy_count, UINT32_MAX / 4, "copy_count", failure)) != GX_OK ||
        (result = gxsp_check_count(model->element_count, UINT32_MAX / 4, "element_count", failure)) != GX_OK ||
        (result = gxsp_check_count(model->material_count, UINT32_MAX, "material_count", failure)) != GX_OK)
        return result;
    if (model->constraint_count > model->copy_count)
        return gxsp_fail(failure, GX_ERROR_LIMIT, "constraint_count", SIZE_MAX);
    for (e = 0; e < model->material_count && result == GX_OK; e++)
        result = gxsp_check_material(&model->materials[e], e, failure);
    for (e = 0; e < model->element_count && result == GX_OK; e++)
        result = gxsp_check_element(&model->elements[e], model, e, failure);
    for (e = 0; e < model->constraint_count && result == GX_OK; e++)
        result = gxsp_check_constraint(&model->constraints[e], model->copy_count, e, failure);
    return result == GX_OK && model->positions
             ? gxsp_check_vector(model->positions, model->copy_count, "positions", failure)
             : result;
}

/* dt within the range where its square and the inverse of that are finite */
static int gxsp_dt_fits(double dt) { return dt >= 1e-100 && dt <= 1e100; }

/* The time step, and with BDF2 the one before */
static gx_result gxsp_check_times(const gxs_step_desc *step, gx_failure *failure) {
    const int history = step->integrator == GXS_BDF2 && step->previous_displacement;
    gx_result result;
    if ((int)step->integrator < 0 || step->integrator > GXS_EXPLICIT) return gxsp_refuse(failure, "integrator");
    if ((result = gxsp_check_size(step->dt, "dt", SIZE_MAX, failure)) != GX_OK ||
        (result = gxsp_check_finite(&step->previous_dt, 1, "previous_dt", SIZE_MAX, failure)) != GX_OK)
        return result;
    if (step->dt <= 0 && step->integrator != GXS_STATIC) return gxsp_refuse(failure, "dt");
    if (history && !step->previous_velocity) return gxsp_refuse(failure, "previous_velocity");
    if (history && step->previous_dt <= 0) return gxsp_refuse(failure, "previous_dt");
    if (step->dt > 0 && !gxsp_dt_fits(step->dt)) return gxsp_fail(failure, GX_ERROR_RANGE, "dt", SIZE_MAX);
    if (history && !gxsp_dt_fits(step->previous_dt)) return gxsp_fail(failure, GX_ERROR_RANGE, "previous_dt", SIZE_MAX);
    return GX_OK;
}

/* The numbers of a step that are 0 or more */
static gx_result gxsp_check_sizes(const gxs_step_desc *step, gx_failure *failure) {
    gx_result result;
    if ((result = gxsp_check_size(step->newton_tolerance, "newton_tolerance", SIZE_MAX, failure)) != GX_OK ||
        (result = gxsp_check_size(step->cg_tolerance, "cg_tolerance", SIZE_MAX, failure)) != GX_OK ||
        (result = gxsp_check_size(step->mass_damping, "mass_damping", SIZE_MAX, failure)) != GX_OK ||
        (result = gxsp_check_size(step->sleep_speed, "sleep_speed", SIZE_MAX, failure)) != GX_OK ||
        (result = gxsp_check_size(step->sleep_time, "sleep_time", SIZE_MAX, failure)) != GX_OK ||
        (result = gxsp_check_size(step->budget_seconds, "budget_seconds", SIZE_MAX, failure)) != GX_OK ||
        (result = gxsp_check_size(step->quality, "quality", SIZE_MAX, failure)) != GX_OK)
        return result;
    if (step->quality > 0 && step->integrator == GXS_STATIC) return gxsp_refuse(failure, "quality");
    return step->cg_tolerance >= 1 ? gxsp_refuse(failure, "cg_tolerance") : GX_OK;
}

static gx_result gxsp_check_step(const gxs_step_desc *step, gx_failure *failure) {
    gx_result result;
    if (!step) return gxsp_refuse(failure, "step");
    if ((result = gxsp_check_times(step, failure)) != GX_OK || (result = gxsp_check_sizes(step, failure)) != GX_OK ||
        (result = gxsp_check_finite(step->gravity, 3, "gravity", SIZE_MAX, failure)) != GX_OK ||
        (result = gxsp_check_array(step->springs, step->spring_count, "springs", failure)) != GX_OK ||
        (result = gxsp_check_array(step->points, step->point_count, "points", failure)) != GX_OK ||
        (result = gxsp_check_array(step->planes, step->plane_count, "planes", failure)) != GX_OK ||
        (result = gxsp_check_array(step->pairs, step->pair_count, "pairs", failure)) != GX_OK)
        return result;
    if (step->pair_count > 0 && step->integrator == GXS_MIDPOINT && !(step->quality > 0))
        return gxsp_refuse(failure, "pairs");
    if (step->budget_seconds > 0 && !step->clock) return gxsp_refuse(failure, "clock");
    if (step->sleep_speed > 0 && !step->rest_times) return gxsp_refuse(failure, "rest_times");
    if (step->spring_count >= SIZE_MAX / 1024) return gxsp_fail(failure, GX_ERROR_LIMIT, "spring_count", SIZE_MAX);
    if (step->point_count >= SIZE_MAX / 1024) return gxsp_fail(failure, GX_ERROR_LIMIT, "point_count", SIZE_MAX);
    if (step->pair_count >= SIZE_MAX / 1024) return gxsp_fail(failure, GX_ERROR_LIMIT, "pair_count", SIZE_MAX);
    return GX_OK;
}

/* Does everything that names copies use the model's numbering? */
static gx_result gxsp_check_epochs(const gxs_step_desc *step, uint64_t epoch, gx_failure *failure) {
    size_t i;
    if ((step->forces || step->targets) && step->epoch != epoch)
        return gxsp_fail(failure, GX_ERROR_STALE, "epoch", SIZE_MAX);
    for (i = 0; i < step->spring_count; i++)
        if (step->springs[i].point.epoch != epoch) return gxsp_fail(failure, GX_ERROR_STALE, "springs.point.epoch", i);
    for (i = 0; i < step->point_count; i++)
        if (step->points[i].epoch != epoch) return gxsp_fail(failure, GX_ERROR_STALE, "points.epoch", i);
    for (i = 0; i < step->pair_count; i++)
        if (step->pairs[i].point.epoch != epoch) return gxsp_fail(failure, GX_ERROR_STALE, "pairs.point.epoch", i);
    return GX_OK;
}

/* names: of the point's count, copy, weight, copies, weights, position */
static gx_result gxsp_check_point(const gxs_point *point, size_t n, const char *const names[6], size_t index,
                                  gx_failure *failure) {
    const char *const *own = names + (point->copies ? 3 : 1);
    uint32_t k;
    if (point->count == 0) return gxsp_fail(failure, GX_ERROR_ARGUMENT, names[0], index);
    if (point->count > GXS_POINT_MOST) return gxsp_fail(failure, GX_ERROR_LIMIT, names[0], index);
    if (!point->copies && (point->count > GXS_POINT_OWN || point->weights))
        return gxsp_fail(failure, GX_ERROR_ARGUMENT, names[3], index);
    if (point->copies && !point->weights) return gxsp_fail(failure, GX_ERROR_ARGUMENT, names[4], index);
    for (k = 0; k < point->count; k++)
        if (gxsp_copies(point)[k] >= n) return gxsp_fail(failure, GX_ERROR_INDEX, own[0], index);
    if (gxsp_first_not_finite(gxsp_weights(point), point->count) < point->count)
        return gxsp_fail(failure, GX_ERROR_NOT_FINITE, own[1], index);
    return gxsp_check_finite(point->position, 3, names[5], index, failure);
}

static gx_result gxsp_check_plane(const gxs_plane *plane, size_t index, gx_failure *failure) {
    gx_result result;
    if ((result = gxsp_check_finite(plane->normal, 3, "planes.normal", index, failure)) != GX_OK ||
        (result = gxsp_check_finite(&plane->offset, 1, "planes.offset", index, failure)) != GX_OK ||
        (result = gxsp_check_size(plane->stiffness, "planes.stiffness", index, failure)) != GX_OK ||
        (result = gxsp_check_size(plane->friction, "planes.friction", index, failure)) != GX_OK ||
        (result = gxsp_check_size(plane->sticking_speed, "planes.sticking_speed", index, failure)) != GX_OK)
        return result;
    return fabs(gxsp_dot(plane->normal, plane->normal, 1) - 1) > 1e-6
             ? gxsp_fail(failure, GX_ERROR_ARGUMENT, "planes.normal", index)
             : GX_OK;
}

/* A pair of a step. Weights are 0 in sum, or 1, up to the rounding of those who made them. affine: of the model whose
 * vectors it names, or NULL */
static gx_result gxsp_check_pair(const gxs_step_desc *step, size_t index, size_t n, const gxsp_affine *affine,
                                 gx_failure *failure) {
    static const char *const names[6] = {"pairs.point.count",  "pairs.point.copy",    "pairs.point.weight",
                                         "pairs.point.copies", "pairs.point.weights", "pairs.point.position"};
    const gxs_pair *pair = &step->pairs[index];
    double sum = pair->flags & GXS_PAIR_OUTSIDE ? -1 : 0, size = 0;
    uint32_t k;
    gx_result result;
    if (pair->flags > (GXS_PAIR_OUTSIDE | GXS_PAIR_WAKES))
        return gxsp_fail(failure, GX_ERROR_ARGUMENT, "pairs.flags", index);
    if ((result = gxsp_check_point(&pair->point, n, names, index, failure)) != GX_OK ||
        (result = gxsp_check_finite(pair->way, 3, "pairs.way", index, failure)) != GX_OK ||
        (result = gxsp_check_finite(pair->normal, 3, "pairs.normal", index, failure)) != GX_OK ||
        (result = gxsp_check_finite(&pair->offset, 1, "pairs.offset", index, failure)) != GX_OK ||
        (result = gxsp_check_size(pair->stiffness, "pairs.stiffness", index, failure)) != GX_OK ||
        (result = gxsp_check_size(pair->friction, "pairs.friction", index, failure)) != GX_OK ||
        (result = gxsp_check_size(pair->sticking_speed, "pairs.sticking_speed", index, failure)) != GX_OK)
        return result;
    for (k = 0; k < pair->point.count; k++) {
        sum += gxsp_hides(affine, gxsp_copies(&pair->point)[k]) ? 0 : gxsp_weights(&pair->point)[k];
        size += fabs(gxsp_weights(&pair->point)[k]);
    }
    if (size > 1e30) return gxsp_fail(failure, GX_ERROR_RANGE, names[pair->point.copies ? 4 : 2], index);
    if (fabs(sum) > (pair->flags & GXS_PAIR_OUTSIDE ? 1e-9 : 1e-12) * size)
        return gxsp_fail(failure, GX_ERROR_ARGUMENT, names[pair->point.copies ? 4 : 2], index);
    if (fabs(gxsp_dot(pair->normal, pair->normal, 1) - 1) > 1e-6)
        return gxsp_fail(failure, GX_ERROR_ARGUMENT, "pairs.normal", index);
    return step->pair_slips ? gxsp_check_finite(step->pair_slips + 3 * index, 3, "pair_slips", index, failure) : GX_OK;
}

/* Springs, contact points, planes and pairs of a step. affine: see gxsp_check_pair */
static gx_result gxsp_check_points(const gxs_step_desc *step, size_t n, const gxsp_affine *affine,
                                   gx_failure *failure) {
    static const char *const of_springs[6] = {"springs.point.count",   "springs.point.copy",
                                              "springs.point.weight",  "springs.point.copies",
                                              "springs.point.weights", "springs.point.position"};
    static const char *const of_points[6] = {"points.count",  "points.copy",    "points.weight",
                                             "points.copies", "points.weights", "points.position"};
    gx_result result = GX_OK;
    size_t i;
    for (i = 0; i < step->spring_count && result == GX_OK; i++) {
        const gxs_spring *spring = &step->springs[i];
        if ((result = gxsp_check_point(&spring->point, n, of_springs, i, failure)) == GX_OK &&
            (result = gxsp_check_finite(spring->target, 3, "springs.target", i, failure)) == GX_OK)
            result = gxsp_check_size(spring->stiffness, "springs.stiffness", i, failure);
    }
    for (i = 0; i < step->point_count && result == GX_OK; i++)
        result = gxsp_check_point(&step->points[i], n, of_points, i, failure);
    for (i = 0; i < step->plane_count && result == GX_OK; i++) result = gxsp_check_plane(&step->planes[i], i, failure);
    for (i = 0; i < step->pair_count && result == GX_OK; i++) result = gxsp_check_pair(step, i, n, affine, failure);
    return result;
}

static gx_result gxsp_check_all(const gxs_step_desc *step, size_t n, uint64_t epoch, const gxsp_affine *affine,
                                gx_failure *failure) {
    gx_result result = gxsp_check_step(step, failure);
    if (result == GX_OK) result = gxsp_check_epochs(step, epoch, failure);
    return result == GX_OK ? gxsp_check_points(step, n, affine, failure) : result;
}

GXFEM_API gx_result gxs_step_check(const gxs_step_desc *step, size_t copy_count, uint64_t epoch, gx_failure *failure) {
    gx_failure ignored;
    if (failure == NULL) failure = &ignored;
    gxsp_end(failure, GX_OK);
    return gxsp_check_all(step, copy_count, epoch, NULL, failure);
}

/* Every array that a step reads */
static gx_result gxsp_check_vectors(const gxs_step_desc *step, size_t n, const double *displacement,
                                    const double *velocity, const uint8_t *held, gx_failure *failure) {
    gx_result result = gxsp_check_vector(displacement, n, "displacement", failure);
    size_t i;
    if (result == GX_OK) result = gxsp_check_vector(velocity, n, "velocity", failure);
    if (result == GX_OK && step->forces) result = gxsp_check_vector(step->forces, n, "forces", failure);
    if (result == GX_OK && step->integrator == GXS_BDF2 && step->previous_displacement) {
        result = gxsp_check_vector(step->previous_displacement, n, "previous_displacement", failure);
        if (result == GX_OK) result = gxsp_check_vector(step->previous_velocity, n, "previous_velocity", failure);
    }
    if (result == GX_OK && step->sleep_speed > 0 && (i = gxsp_first_not_finite(step->rest_times, n)) < n)
        result = gxsp_fail(failure, GX_ERROR_NOT_FINITE, "rest_times", i);
    for (i = 0; step->targets && result == GX_OK && i < n; i++)
        if (held[i]) result = gxsp_check_finite(step->targets + 3 * i, 3, "targets", i, failure);
    return result;
}

/* Affine copies of a change. They and their hidden vectors are as in a model. */
static gx_result gxsp_check_changed_affine(const gxs_solver *solver, const gxs_change *change, gxsp_pool *scratch,
                                           gx_failure *failure) {
    uint8_t *owned = change->affine ? (uint8_t *)gxsp_take(scratch, change->copy_count, 1) : NULL;
    gxs_model model;
    if (!owned) return GX_OK; /* without memory the caller fails */
    memset(&model, 0, sizeof model);
    model.copy_count = change->copy_count;
    model.positions = solver->system->model.positions;
    model.held = change->held;
    model.affine = change->affine;
    model.affine_length = solver->system->affine.place ? solver->system->affine.length : 1;
    model.elements = change->elements;
    model.element_count = change->element_count;
    model.constraints = change->constraints;
    model.constraint_count = change->constraint_count;
    return gxsp_check_affine(&model, solver, owned, failure);
}

/* Is the change one of this model? */
static gx_result gxsp_check_change(const gxsp_system *system, const gxs_change *change, gx_failure *failure) {
    gxs_model model;
    gx_result result;
    size_t i;
    if (!change) return gxsp_refuse(failure, "change");
    if (!change->origins) return gxsp_refuse(failure, "origins");
    if ((result = gxsp_check_array(change->groups, change->group_count, "groups", failure)) != GX_OK ||
        (result = gxsp_check_array(change->elements, change->element_count, "elements", failure)) != GX_OK ||
        (result = gxsp_check_array(change->constraints, change->constraint_count, "constraints", failure)) != GX_OK ||
        (result = gxsp_check_count(change->copy_count, UINT32_MAX / 4, "copy_count", failure)) != GX_OK)
        return result;
    if (change->element_count >= UINT32_MAX / 4 - system->model.element_count)
        return gxsp_fail(failure, GX_ERROR_LIMIT, "element_count", SIZE_MAX);
    if (change->constraint_count > change->copy_count)
        return gxsp_fail(failure, GX_ERROR_LIMIT, "constraint_count", SIZE_MAX);
    for (i = 0; i < change->copy_count; i++)
        if (change->origins[i] >> 1 >= system->model.n) return gxsp_fail(failure, GX_ERROR_INDEX, "origins", i);
    for (i = 1; i < change->group_count; i++)
        if (change->groups[i - 1] >= change->groups[i]) return gxsp_fail(failure, GX_ERROR_ARGUMENT, "groups", i);
    for (i = 1; i < change->element_count; i++)
        if (change->elements[i - 1].group > change->elements[i].group)
            return gxsp_fail(failure, GX_ERROR_ARGUMENT, "elements.group", i);
    memset(&model, 0, sizeof model);
    model.copy_count = change->copy_count;
    model.material_count = system->model.material_count;
    for (i = 0; i < change->element_count && result == GX_OK; i++)
        result = change->elements[i].group < GXSP_GROUPS ? gxsp_check_element(&change->elements[i], &model, i, failure)
                                                         : gxsp_fail(failure, GX_ERROR_LIMIT, "elements.group", i);
    for (i = 0; i < change->constraint_count && result == GX_OK; i++)
        result = gxsp_check_constraint(&change->constraints[i], change->copy_count, i, failure);
    return result;
}

/* A balance of forces without inertia needs every component to be held, by a copy or a spring. */
static gx_result gxsp_check_free(const gxsp_problem *problem, gx_failure *failure) {
    const gxsp_system *system = problem->system;
    const gxs_step_desc *step = problem->step;
    size_t i, k;
    gxsp_untouch_components(problem->system);
    for (k = 0; k < step->spring_count; k++) {
        const gxs_point *point = &step->springs[k].point;
        for (i = 0; i < point->count && step->springs[k].stiffness > 0; i++)
            if (fabs(gxsp_weights(point)[i]) > 0)
                system->model.components[system->model.component[gxsp_copies(point)[i]]].state |= GXSP_TOUCHED;
    }
    for (i = 0; i < system->model.n && !(problem->rate > 0); i++)
        if (!(system->model.components[system->model.component[i]].state & (GXSP_HELD | GXSP_TOUCHED | GXSP_ASLEEP)))
            return gxsp_fail(failure, GX_ERROR_FREE, NULL, i);
    return GX_OK;
}

/* >>quality: steps by the error asked for -------------------------------------------------------------------------- */

/* In: a step's description with an error in place of an integrator. Out: as of a step. One step is divided into several
 * of >>newton and >>midpoint, or is one of >>leapfrog: whichever promises the error for less work. Touches gxsp_tempo.
 *
 * How fast the body moves is measured on the way of a step, from u0 to u1, by the forces at its ends:
 *
 *     w^2 = (u1 - u0) . (f(u1) - f(u0)) / |u1 - u0|_M^2,
 *
 * as sums over steps. Motion within a step is averaged out, so parts that flutter count for little. A vibration of
 * amplitude A about an elastic displacement D errs by A / sqrt(A^2 + D^2) of what a vibration without D would: what has
 * come to rest needs no short steps. A is the way of a step over w dt, or that way itself where the step is longer than
 * a radian; D^2 = 2 U / w^2. */

/* Memory for the terms of a step */
static int gxsp_reserve_terms(gxsp_lasting *lasting, const gxs_step_desc *step) {
    const size_t count = gxsp_point_count(step);
    size_t shares = 0, i;
    for (i = 0; i < count; i++) shares += gxsp_point_of(step, i)->count;
    lasting->pool.failed = 0;
    if (count > lasting->room) {
        gxsp_term *larger = (gxsp_term *)gxsp_grow(&lasting->pool, lasting->term, 0, count, sizeof *larger);
        if (!larger) return 0;
        lasting->term = larger;
        lasting->room = count;
    }
    if (shares > lasting->share_room) {
        gxsp_share *larger = (gxsp_share *)gxsp_grow(&lasting->pool, lasting->share, 0, shares, sizeof *larger);
        if (!larger) return 0;
        lasting->share = larger;
        lasting->share_room = shares;
    }
    if (step->pair_count > lasting->grip_room) {
        gxsp_grip *larger = (gxsp_grip *)gxsp_grow(&lasting->pool, lasting->grip, 0, step->pair_count, sizeof *larger);
        if (!larger) return 0;
        lasting->grip = larger;
        lasting->grip_room = step->pair_count;
    }
    return 1;
}

/* One step of an integrator. The description has been checked. */
static gx_result gxsp_step_once(gxs_solver *solver, const gxs_step_desc *step, double *displacement, double *velocity,
                                gxs_step_report *report, gx_failure *failure) {
    gxsp_problem problem;
    gx_result result;
    if (!gxsp_reserve_terms(&solver->lasting, step) ||
        (step->integrator == GXS_EXPLICIT && !gxsp_leap_make(solver->system, GXSP_LEAP_ALL)) ||
        (step->quick > 0 && !gxsp_quick_make(solver->system)))
        return gxsp_end(failure, GX_ERROR_MEMORY);
    memset(&problem, 0, sizeof problem);
    problem.system = solver->system;
    problem.system->state.product_rate = -1;
    problem.step = step;
    problem.given = displacement;
    gxsp_find_grips(&problem);
    problem.cg_iterations = step->cg_iterations ? step->cg_iterations : 1000;
    problem.cg_tolerance = step->cg_tolerance > 0 ? step->cg_tolerance : step->integrator == GXS_MIDPOINT ? 1e-3 : 1e-2;
    problem.start = gxsp_now(&problem);
    gxsp_choose_integrator(&problem);
    gxsp_choose_sleepers(&problem, displacement, velocity);
    problem.system->state.failed = 1;
    if ((result = gxsp_check_free(&problem, failure)) != GX_OK) return result;
    problem.report.active_unknowns = problem.system->state.active;
    if (!(gxsp_leap_allowed(&problem) && gxsp_leap_step(&problem, displacement, velocity)) &&
        !(gxsp_quick_allowed(&problem) && gxsp_quick_step(&problem, displacement, velocity))) {
        problem.system->leap.served = 0;
        gxsp_begin(&problem, velocity);
        result = gxsp_minimise(&problem);
        if (problem.starved) result = GX_ERROR_MEMORY;
        if (result == GX_OK) gxsp_find_end(&problem, displacement, velocity);
    }
    if (result == GX_OK) result = gxsp_finish(&problem, displacement, velocity);
    if (result != GX_OK) return gxsp_end(failure, result);
    problem.system->state.failed = 0;
    gxsp_report_springs(&problem);
    problem.report.parts = 1;
    problem.report.integrator =
        step->integrator == GXS_EXPLICIT && problem.report.substeps == 0 ? GXS_BDF1 : step->integrator;
    problem.report.seconds = gxsp_now(&problem) - problem.start;
    *report = problem.report;
    return GX_OK;
}

/* What a step by quality is made of */
typedef struct gxsp_plan {
    gxs_integrator integrator;
    uint32_t parts, substeps, quick;
    double cg_tolerance;
    double error, work; /* expected; work in evaluations of explicit forces */
} gxsp_plan;

/* What is kept of a step's start, n copies and so many pairs: in one array, by this order. One takes forces after the
 * last part. */
typedef struct gxsp_parts {
    double *displacement, *velocity, *target, *rest_times, *slips;
    double *before, *now; /* displacement and velocity at the start of the last part and of this one; BDF2 only */
    double *from;         /* where the way begins on which motion is measured */
    double seconds;       /* that the way took */
} gxsp_parts;

static int gxsp_parts_reserve(gxs_solver *solver, const gxs_step_desc *step, gxsp_parts *parts) {
    gxsp_lasting *lasting = &solver->lasting;
    const size_t n = solver->system->model.n, count = 25 * n + 3 * step->pair_count;
    lasting->pool.failed = 0;
    if (count > lasting->part_room) {
        double *larger = (double *)gxsp_grow(&lasting->pool, lasting->parts, 0, count, sizeof *larger);
        if (!larger) return 0;
        lasting->parts = larger;
        lasting->part_room = count;
        lasting->tempo.before_dt = 0;
    }
    parts->before = lasting->parts;
    parts->now = parts->before + 6 * n;
    parts->from = parts->now + 6 * n;
    parts->displacement = parts->from + 3 * n;
    parts->velocity = parts->displacement + 3 * n;
    parts->target = parts->velocity + 3 * n;
    parts->rest_times = parts->target + 3 * n;
    parts->slips = parts->rest_times + n;
    return 1;
}

/* Keeps the state at the start, or with `back` restores it. */
static void gxsp_parts_copy(const gxsp_parts *parts, const gxs_step_desc *step, size_t n, int back,
                            double *displacement, double *velocity) {
    double *kept[4], *own[4];
    const size_t count[4] = {3 * n, 3 * n, n, 3 * step->pair_count};
    int k;
    kept[0] = parts->displacement, kept[1] = parts->velocity, kept[2] = parts->rest_times, kept[3] = parts->slips;
    own[0] = displacement, own[1] = velocity;
    own[2] = step->sleep_speed > 0 ? step->rest_times : NULL;
    own[3] = step->pair_slips;
    for (k = 0; k < 4; k++)
        if (own[k]) memcpy(back ? own[k] : kept[k], back ? kept[k] : own[k], count[k] * sizeof(double));
}

/* Frequency of the motion, rad/s; 0: not known, or nothing resists */
static double gxsp_tempo_frequency(const gxsp_tempo *tempo) {
    return tempo->motion > 0 && tempo->work > 0 ? sqrt(tempo->work / tempo->motion) : 0;
}

/* The share of the motion in what is displaced, 0 ... 1. The frequency is known. */
static double gxsp_tempo_share(const gxsp_tempo *tempo) {
    return sqrt(tempo->motion / (tempo->motion + 2 * fmax(0, tempo->stored) * tempo->weight));
}

/* The work of L on a way, J */
static double gxsp_leap_resistance(const gxsp_system *system, const double *from, const double *displacement) {
    const gxsp_leap *leap = &system->leap;
    gxsp_vector4 sums[GXSP_LEAP_ROWS];
    double sum = 0;
    size_t i, r, c;
    for (i = 0; i < system->model.n; i++) {
        for (c = 0; c < 3; c++)
            leap->last[i][c] = system->state.still[i] ? 0 : (float)(displacement[3 * i + c] - from[3 * i + c]);
        leap->last[i][3] = 0;
    }
    for (i = 0; i < system->model.n; i += GXSP_LEAP_ROWS) {
        gxsp_leap_group_product(leap, i / GXSP_LEAP_ROWS, (const gxsp_vector4 *)leap->last, sums);
        for (r = 0; r < GXSP_LEAP_ROWS && i + r < system->model.n; r++)
            for (c = 0; c < 3; c++) sum += (double)leap->last[leap->order[i + r]][c] * (double)sums[r][c];
    }
    return sum;
}

/* Adds a way to the sums. seconds: that it took, of a step of dt; from: its start; forces: 3n numbers to write to */
static void gxsp_tempo_measure(gxs_solver *solver, double dt, double seconds, const double *from,
                               const double *displacement, const double *velocity, double *forces) {
    gxsp_system *system = solver->system;
    gxsp_tempo *tempo = &solver->lasting.tempo;
    const double radians = gxsp_tempo_frequency(tempo) * dt * (tempo->steps + 1), each = 1 / (seconds * seconds),
                 keep = exp(-fmin(0.25 * radians, GXSP_QUALITY_FORGET));
    double work = 0, motion = 0, stored = 0, kinetic = 0;
    uint32_t p;
    size_t i;
    gxsp_evaluate_elements(system, 0, from, NULL, 0, forces);
    gxsp_evaluate_elements(system, 0, displacement, NULL, 0, system->vectors.force);
    for (p = 0; p < system->model.component_count; p++) stored += system->model.components[p].energies[0];
    for (i = 0; i < 3 * system->model.n; i++) {
        const double way = system->state.still[i / 3] ? 0 : displacement[i] - from[i];
        work += each * way * (system->vectors.force[i] - forces[i]);
        motion += each * system->model.lumped[i / 3] * way * way;
        if (!system->state.still[i / 3]) kinetic += system->model.lumped[i / 3] * velocity[i] * velocity[i];
    }
    tempo->steps = 0;
    if (!gxsp_finite(work + motion + stored)) return;
    if (tempo->leaps && system->leap.suits) {
        tempo->resist[0] = keep * tempo->resist[0] + each * gxsp_leap_resistance(system, from, displacement);
        tempo->resist[1] = keep * tempo->resist[1] + motion;
    }
    tempo->work = keep * tempo->work + work;
    tempo->motion = keep * tempo->motion + motion;
    tempo->weight = keep * tempo->weight + 1;
    tempo->stored = stored;
    tempo->hidden = kinetic > GXSP_QUALITY_HIDDEN * tempo->motion / tempo->weight;
    tempo->measures++;
}

/* Time in which errors add up */
static double gxsp_quality_time(const gxs_step_desc *step) {
    return step->mass_damping > 0 ? fmin(GXSP_QUALITY_TIME, 2 / step->mass_damping) : GXSP_QUALITY_TIME;
}

/* Can a step be quick, and is it soft enough for loose solves? */
static int gxsp_is_soft(const gxsp_system *system, const gxs_step_desc *step) {
    const gxsp_leap *leap = &system->leap;
    const double factor = leap->factor > 0 ? leap->factor : GXSP_LEAP_FACTOR;
    return leap->made == GXSP_LEAP_ALL && gxsp_quick_suits(system, step) &&
           0.5 * step->dt * sqrt(factor * leap->top) <= GXSP_QUALITY_SOFT;
}

/* Makes the parts of a plan quick, solved as exactly as the error demands: half of it is theirs. */
static void gxsp_plan_quick(gxsp_plan *plan, double error) {
    const double tolerance = fmin(sqrt(0.5 * error / GXSP_QUALITY_LEFT), GXSP_QUALITY_LOOSE);
    plan->quick = GXSP_QUALITY_ITERATIONS;
    plan->cg_tolerance = tolerance;
    plan->error += GXSP_QUALITY_LEFT * tolerance * tolerance;
    plan->work = (GXSP_WORK_QUICK + GXSP_WORK_ITERATION * (1 + 0.4 / tolerance)) * plan->parts + GXSP_WORK_STEP;
}

/* The implicit steps for an error, a power of two. They are the midpoint rule's, or BDF2's where sides touch each
 * other, where thin parts follow others (there each change of the midpoint rule's step costs motion), and where
 * vibrations hide that the midpoint rule would keep forever. Motion that would take more than GXS_PARTS steps of a
 * radian is damped by backward Euler; so is motion whose share of the displacement is below the error, and what mass
 * damping ends within a step (brief: the share of the step that it lasts). */
static gxsp_plan gxsp_plan_implicit(const gxs_solver *solver, const gxs_step_desc *step, double error) {
    const gxsp_tempo *tempo = &solver->lasting.tempo;
    const double w = gxsp_tempo_frequency(tempo), radians = w * step->dt,
                 later = w * gxsp_quality_time(step) + GXSP_QUALITY_MORE, share = w > 0 ? gxsp_tempo_share(tempo) : 0,
                 brief = step->mass_damping * step->dt > 2 ? 2 / (step->mass_damping * step->dt) : 1,
                 euler = GXSP_QUALITY_EULER * radians * share * brief;
    const int lags = step->pair_count > 0 || solver->system->model.follower_count > 0 || tempo->hidden,
              damps = brief < 1 || radians > GXS_PARTS || share <= error;
    const double second = (lags ? GXSP_QUALITY_BDF2 : GXSP_QUALITY_MIDPOINT) * radians * radians * later * share;
    double parts = damps ? euler / error : sqrt(second / error);
    gxsp_plan plan;
    memset(&plan, 0, sizeof plan);
    if (radians > GXS_PARTS || share * brief <= error) parts = 1;
    if (tempo->measures == 0) parts = error > GXSP_QUALITY_COARSE ? 2 : 4;
    for (plan.parts = 1; plan.parts < GXS_PARTS && plan.parts * GXSP_QUALITY_SLACK < parts;) plan.parts *= 2;
    plan.integrator = tempo->measures > 0 && (damps || radians > plan.parts) ? GXS_BDF1
                    : lags                                                   ? GXS_BDF2
                                                                             : GXS_MIDPOINT;
    plan.error = plan.integrator == GXS_BDF1 ? fmin(euler / plan.parts, share) : second / plan.parts / plan.parts;
    plan.cg_tolerance = plan.parts == 1 && !lags ? 1e-1 : 1e-2;
    if (plan.parts > 8) plan.cg_tolerance *= 64.0 / plan.parts / plan.parts;
    plan.work = GXSP_WORK_IMPLICIT * plan.parts + GXSP_WORK_STEP;
    if (tempo->measures > 0 && plan.parts == 1 && radians <= 1 && gxsp_is_soft(solver->system, step))
        gxsp_plan_quick(&plan, error);
    return plan;
}

/* The explicit step for an error, without targets and points; work 0: it cannot be explicit. The filter adds h^2 L / 12
 * to the inertia, so that L in place of the body's stiffness gives the error, and its masses have an error of their
 * own. */
static gxsp_plan gxsp_plan_explicit(const gxs_solver *solver, const gxs_step_desc *step, double error) {
    const gxsp_leap *leap = &solver->system->leap;
    const gxsp_tempo *tempo = &solver->lasting.tempo;
    const double factor = leap->factor > 0 ? leap->factor : GXSP_LEAP_FACTOR, w = gxsp_tempo_frequency(tempo),
                 limit = 0.5 * step->dt * sqrt(factor * leap->top), /* substeps without a filter */
        degrees = fmax(1, GXSP_QUALITY_DEGREE - (double)tempo->refused),
                 later = w * gxsp_quality_time(step) + GXSP_QUALITY_MORE, share = w > 0 ? gxsp_tempo_share(tempo) : 1,
                 all = tempo->resist[1] > 0
                         ? GXSP_QUALITY_MIDPOINT * tempo->resist[0] / tempo->resist[1] * step->dt * step->dt * later *
                               share
                         : GXSP_QUALITY_COARSE * limit * limit / (GXSP_LEAP_DEGREE * GXSP_LEAP_DEGREE),
                 substeps = ceil(fmin(fmax(sqrt(all / error), limit / degrees), limit));
    gxsp_plan plan;
    uint32_t degree;
    memset(&plan, 0, sizeof plan);
    if (!leap->suits || !(0.5 * step->dt * step->mass_damping < 1) || !(substeps <= GXSP_QUALITY_SUBSTEPS)) return plan;
    plan.integrator = GXS_EXPLICIT;
    plan.parts = 1;
    plan.substeps = (uint32_t)fmax(1, substeps);
    degree = gxsp_leap_degree(leap, step->dt / plan.substeps, factor);
    plan.error = GXSP_LEAP_MASS * later * share / 6;
    if (degree > 1) plan.error += all / plan.substeps / plan.substeps * (1 - 1.0 / degree / degree);
    plan.work = plan.substeps * (1 + GXSP_WORK_PRODUCT * (degree - 1.0)) + GXSP_WORK_STEP;
    return plan;
}

/* What takes less work for this error. leaps: explicit steps may be taken */
static gxsp_plan gxsp_plan_for(const gxs_solver *solver, const gxs_step_desc *step, double error, int leaps) {
    gxsp_plan plan = gxsp_plan_implicit(solver, step, error), other;
    if (!leaps) return plan;
    other = gxsp_plan_explicit(solver, step, error);
    return other.work > 0 && other.work < plan.work ? other : plan;
}

/* A plan for the error asked for, or for the least that fits into the time. *memory: there was none for explicit steps
 */
static gxsp_plan gxsp_plan_make(gxs_solver *solver, const gxs_step_desc *step, int *memory) {
    gxsp_tempo *tempo = &solver->lasting.tempo;
    gxsp_plan plan;
    double error;
    int leaps = tempo->waiting == 0;
    if ((tempo->age == 0 && tempo->measures > 0) || gxsp_point_count(step) > 0 || step->targets) leaps = 0;
    if (leaps && !gxsp_leap_make(solver->system, GXSP_LEAP_ALL)) *memory = 0, leaps = 0;
    tempo->age += tempo->age < 1;
    tempo->leaps = leaps;
    plan = gxsp_plan_for(solver, step, step->quality, leaps);
    for (error = step->quality; step->budget_seconds > 0 && error < 1e3; error *= 2) {
        const gxsp_plan other = gxsp_plan_for(solver, step, error, leaps);
        if (other.work < plan.work) plan = other;
        if (plan.work * tempo->pace <= step->budget_seconds) break;
    }
    if (step->budget_seconds > 0 && plan.work * tempo->pace > step->budget_seconds && plan.integrator == GXS_MIDPOINT)
        plan.integrator = GXS_BDF1;
    if (tempo->waiting > 0) tempo->waiting--;
    return plan;
}

/* Adds what a part reports. */
static void gxsp_report_add(gxs_step_report *sum, const gxs_step_report *part) {
    const gxs_step_report before = *sum;
    *sum = *part;
    sum->parts += before.parts;
    sum->newton_iterations += before.newton_iterations;
    sum->cg_iterations += before.cg_iterations;
    sum->line_search_steps += before.line_search_steps;
    sum->residual = fmax(part->residual, before.residual);
    sum->seconds += before.seconds;
    sum->seconds_linearise += before.seconds_linearise;
    sum->seconds_prepare += before.seconds_prepare;
    sum->seconds_solve += before.seconds_solve;
}

/* One part, by BDF2 with the part before */
static gx_result gxsp_take_part(gxs_solver *solver, gxs_step_desc *part, const gxsp_parts *parts, double *displacement,
                                double *velocity, gxs_step_report *report, gx_failure *failure) {
    gxsp_tempo *tempo = &solver->lasting.tempo;
    const size_t count = 3 * solver->system->model.n;
    const int history = part->integrator == GXS_BDF2;
    gx_result result;
    if (history) {
        memcpy(parts->now, displacement, count * sizeof(double));
        memcpy(parts->now + count, velocity, count * sizeof(double));
    }
    part->previous_displacement = history && tempo->before_dt > 0 ? parts->before : NULL;
    part->previous_velocity = parts->before + count;
    part->previous_dt = tempo->before_dt;
    result = gxsp_step_once(solver, part, displacement, velocity, report, failure);
    if (history) memcpy(parts->before, parts->now, 2 * count * sizeof(double));
    tempo->before_dt = history && result == GX_OK ? part->dt : 0;
    return result;
}

/* All parts of a step, one after the other. The way that is measured is the last radian, in whole parts, or the last
 * part if nothing is known. */
static gx_result gxsp_take_parts(gxs_solver *solver, const gxs_step_desc *step, const gxsp_plan *plan,
                                 gxsp_parts *parts, double *displacement, double *velocity, gxs_step_report *report,
                                 gx_failure *failure) {
    gxs_step_desc part = *step;
    gx_result result = GX_OK;
    const double w = gxsp_tempo_frequency(&solver->lasting.tempo),
                 way = solver->lasting.tempo.measures == 0 ? 1 : ceil(fmin(1, 1 / (w * step->dt)) * plan->parts);
    uint32_t k;
    size_t i;
    part.quality = 0;
    part.quick = plan->quick;
    part.dt = step->dt / plan->parts;
    part.integrator = plan->integrator;
    part.substeps = plan->substeps;
    part.cg_tolerance = plan->cg_tolerance;
    part.newton_iterations = solver->system->affine.count > 0 ? 0 : 1;
    parts->seconds = way * step->dt / plan->parts;
    part.newton_tolerance = 0;
    if (step->targets) part.targets = parts->target;
    memset(report, 0, sizeof *report);
    for (k = 1; k <= plan->parts && result == GX_OK; k++) {
        gxs_step_report own;
        if (k + way - 1 <= plan->parts) memcpy(parts->from, displacement, 3 * solver->system->model.n * sizeof(double));
        for (i = 0; i < 3 * solver->system->model.n && step->targets; i++)
            parts->target[i] =
                k == plan->parts ? step->targets[i]
                : solver->system->model.fixed[i / 3]
                    ? parts->displacement[i] + (step->targets[i] - parts->displacement[i]) * k / plan->parts
                    : 0;
        if (step->budget_seconds > 0) part.budget_seconds = fmax(step->budget_seconds - report->seconds, 1e-9);
        result = gxsp_take_part(solver, &part, parts, displacement, velocity, &own, failure);
        if (result == GX_OK) gxsp_report_add(report, &own);
    }
    return result;
}

/* Measures the way. That of an explicit step of more than a radian is that of a radian at its last velocity. */
static void gxsp_measure(gxs_solver *solver, const gxs_step_desc *step, const gxsp_plan *plan, gxsp_parts *parts,
                         const double *displacement, const double *velocity) {
    const double w = gxsp_tempo_frequency(&solver->lasting.tempo);
    size_t i;
    if (plan->integrator == GXS_EXPLICIT && w * step->dt > 1) {
        parts->seconds = 1 / w;
        for (i = 0; i < 3 * solver->system->model.n; i++) parts->from[i] = displacement[i] - velocity[i] / w;
    }
    gxsp_tempo_measure(solver, step->dt, parts->seconds, parts->from, displacement, velocity, parts->target);
}

static gx_result gxsp_step_by_quality(gxs_solver *solver, const gxs_step_desc *step, double *displacement,
                                      double *velocity, gxs_step_report *report, gx_failure *failure) {
    const size_t n = solver->system->model.n;
    gxsp_tempo *tempo = &solver->lasting.tempo;
    gxsp_parts parts;
    gxsp_plan plan;
    gx_result result;
    int memory = 1;
    if (!gxsp_parts_reserve(solver, step, &parts)) return gxsp_end(failure, GX_ERROR_MEMORY);
    if (tempo->end != gxsp_hash(1, displacement, 3 * n)) tempo->before_dt = 0;
    plan = gxsp_plan_make(solver, step, &memory);
    if (!memory) return gxsp_end(failure, GX_ERROR_MEMORY);
    gxsp_parts_copy(&parts, step, n, 0, displacement, velocity);
    result = gxsp_take_parts(solver, step, &plan, &parts, displacement, velocity, report, failure);
    while (result == GX_OK && plan.integrator == GXS_EXPLICIT && report->substeps == 0 && report->active_unknowns > 0) {
        gxsp_parts_copy(&parts, step, n, 1, displacement, velocity);
        tempo->refused++;
        if (tempo->refused >= GXSP_QUALITY_DEGREE) tempo->waiting = GXSP_QUALITY_WAIT;
        plan = gxsp_plan_for(solver, step, step->quality, tempo->waiting == 0);
        result = gxsp_take_parts(solver, step, &plan, &parts, displacement, velocity, report, failure);
    }
    if (result != GX_OK) {
        gxsp_parts_copy(&parts, step, n, 1, displacement, velocity);
        return result;
    }
    tempo->end = gxsp_hash(1, displacement, 3 * n);
    report->error = tempo->measures > 0 ? plan.error : 0;
    if (report->seconds > 0) tempo->pace = report->seconds / plan.work;
    if (report->active_unknowns == 0) return GX_OK;
    if ((plan.integrator != GXS_EXPLICIT && plan.quick == 0) || tempo->measures < GXSP_QUALITY_FIRST ||
        tempo->steps + 1 >= GXSP_QUALITY_EACH)
        gxsp_measure(solver, step, &plan, &parts, displacement, velocity);
    else
        tempo->steps++;
    return GX_OK;
}

/* >>api: the public functions -------------------------------------------------------------------------------------- */

/* Each checks what it is given, then calls the sections above. Memory of the solver itself is of the allocator,
 * all else of pools. */

GXFEM_API gx_result gxs_solver_set_model(gxs_solver *solver, const gxs_model *model, gx_failure *failure) {
    gx_failure ignored;
    gx_result result;
    gxsp_pool pool, scratch;
    gxsp_system *system;
    size_t bad;
    failure = failure ? failure : &ignored;
    gxsp_end(failure, GX_OK);
    if (!solver) return gxsp_refuse(failure, "solver");
    result = gxsp_check_model(model, failure);
    if (result != GX_OK) return result;
    pool = gxsp_pool_make(&solver->allocator);
    scratch = gxsp_pool_make(&solver->allocator);
    if (model->affine) {
        uint8_t *owned = (uint8_t *)gxsp_take(&scratch, model->copy_count, 1);
        result = owned ? gxsp_check_affine(model, solver, owned, failure) : gxsp_end(failure, GX_ERROR_MEMORY);
        gxsp_release_to(&scratch, NULL);
        if (result != GX_OK) return result;
    }
    system = (gxsp_system *)gxsp_take(&pool, 1, sizeof *system);
    if (!system) return gxsp_end(failure, GX_ERROR_MEMORY);
    system->pool = pool;
    system->multigrid.pool = gxsp_pool_make(&solver->allocator);
    system->jobs = &solver->jobs;
    system->lasting = &solver->lasting;
    bad = gxsp_system_build(system, &scratch, model, solver);
    gxsp_release_to(&scratch, NULL);
    if (bad == SIZE_MAX && !scratch.failed && !system->pool.failed) gxsp_steps_make(system);
    if (bad != SIZE_MAX)
        gxsp_fail(failure, GX_ERROR_ARGUMENT, "constraints", bad);
    else if (scratch.failed || system->pool.failed)
        gxsp_end(failure, GX_ERROR_MEMORY);
    if (failure->result != GX_OK) {
        gxsp_system_destroy(system);
        return failure->result;
    }
    gxsp_system_destroy(solver->system);
    solver->system = system;
    solver->lasting.tempo.age = 0;
    solver->lasting.tempo.before_dt = 0;
    return GX_OK;
}

GXFEM_API gx_result gxs_solver_update(gxs_solver *solver, const gxs_change *change, gx_failure *failure) {
    gx_failure ignored;
    gxsp_pool scratch;
    gxsp_renewal update;
    gxsp_system *system;
    uint8_t *follows;
    size_t bad;
    int fits;
    failure = failure ? failure : &ignored;
    gxsp_end(failure, GX_OK);
    if (!solver) return gxsp_refuse(failure, "solver");
    if (!solver->system) return gxsp_fail(failure, GX_ERROR_SEQUENCE, "gxs_solver_set_model", SIZE_MAX);
    system = solver->system;
    if (gxsp_check_change(system, change, failure) != GX_OK) {
        if (failure->result == GX_ERROR_LIMIT) gxsp_drop_system(solver);
        return failure->result;
    }
    scratch = gxsp_pool_make(&solver->allocator);
    if (gxsp_check_changed_affine(solver, change, &scratch, failure) != GX_OK) {
        gxsp_release_to(&scratch, NULL);
        return failure->result;
    }
    solver->lasting.tempo.age = 0;
    solver->lasting.tempo.before_dt = 0;
    system->state.product_rate = -1;
    memset(&update, 0, sizeof update);
    update.system = system;
    update.scratch = &scratch;
    update.change = change;
    update.before = system->model.n;
    update.successor = (uint32_t *)gxsp_take(&scratch, system->model.n, sizeof(uint32_t));
    update.touched = (uint8_t *)gxsp_take(&scratch, change->copy_count, 1);
    update.alike = (uint8_t *)gxsp_take(&scratch, change->copy_count, 1);
    follows = (uint8_t *)gxsp_take(&scratch, change->copy_count, 1);
    bad = scratch.failed ? SIZE_MAX
                         : gxsp_bad_constraint(change->constraints, change->constraint_count, change->held, follows);
    if (bad != SIZE_MAX) {
        gxsp_release_to(&scratch, NULL);
        return gxsp_fail(failure, GX_ERROR_ARGUMENT, "constraints", bad);
    }
    fits = scratch.failed ||
           (gxsp_is_flexible(system, change) && gxsp_find_successors(&update) && gxsp_update_system(&update));
    gxsp_release_to(&scratch, NULL);
    if (scratch.failed || system->pool.failed || system->multigrid.pool.failed)
        gxsp_end(failure, GX_ERROR_MEMORY);
    else if (!fits)
        gxsp_end(failure, GX_ERROR_LIMIT);
    if (failure->result != GX_OK) gxsp_drop_system(solver);
    return failure->result;
}

GXFEM_API gx_result gxs_solver_linearise(gxs_solver *solver, const double *displacement, double rate, uint32_t exact,
                                         gx_failure *failure) {
    gx_failure ignored;
    gxsp_system *system;
    gxsp_pass pass;
    uint32_t b;
    failure = failure ? failure : &ignored;
    gxsp_end(failure, GX_OK);
    if (!solver) return gxsp_refuse(failure, "solver");
    if (!solver->system) return gxsp_fail(failure, GX_ERROR_SEQUENCE, "gxs_solver_set_model", SIZE_MAX);
    system = solver->system;
    if (gxsp_check_vector(displacement, system->model.n, "displacement", failure) != GX_OK ||
        gxsp_check_size(rate, "rate", SIZE_MAX, failure) != GX_OK)
        return failure->result;
    memset(&pass, 0, sizeof pass);
    pass.system = system;
    pass.materials = system->model.materials;
    pass.rate = system->model.scale * rate;
    pass.from = displacement;
    pass.exact = exact != 0;
    memset(system->state.chunk_still, 0, system->mesh.chunk_count); /* sleeping components are included */
    for (b = 0; b < system->affine.block_count; b++) system->affine.blocks[b].still = 0;
    gxsp_parallel(system->jobs, system->mesh.chunk_count, gxsp_task_linearise, &pass);
    gxsp_over_affine(system, gxsp_task_affine_tangents, &pass, NULL);
    gxsp_mark_still(system);
    system->state.product_rate = gxsp_tangents_finite(system) ? rate : -1;
    return system->state.product_rate < 0 ? gxsp_fail(failure, GX_ERROR_RANGE, "displacement", SIZE_MAX) : GX_OK;
}

GXFEM_API gx_result gxs_solver_product(gxs_solver *solver, const double *direction, double *product,
                                       gx_failure *failure) {
    gx_failure ignored;
    gxsp_system *system;
    gxsp_pass pass;
    failure = failure ? failure : &ignored;
    gxsp_end(failure, GX_OK);
    if (!solver) return gxsp_refuse(failure, "solver");
    if (!direction) return gxsp_refuse(failure, "direction");
    if (!product) return gxsp_refuse(failure, "product");
    if (!solver->system || solver->system->state.product_rate < 0)
        return gxsp_fail(failure, GX_ERROR_SEQUENCE, "gxs_solver_linearise", SIZE_MAX);
    system = solver->system;
    memset(&pass, 0, sizeof pass);
    pass.system = system;
    pass.rate = system->model.scale * system->state.product_rate;
    pass.from = direction;
    pass.sum = product;
    pass.factor = gxsp_unit_factor(direction, 3 * system->model.n);
    if (!(pass.factor > 0)) return gxsp_check_vector(direction, system->model.n, "direction", failure);
    gxsp_parallel(system->jobs, system->mesh.chunk_count, gxsp_task_apply, &pass);
    gxsp_over_ranges(system, gxsp_task_apply_sum, &pass, NULL, 0);
    if (system->affine.count > 0) gxsp_affine_apply_all(system, &pass);
    gxsp_reduce_residual(system, system->model.fixed, product);
    return GX_OK;
}

GXFEM_API void gxs_solver_note_written(const gxs_solver *solver, const uint32_t *origins, size_t count,
                                       const double *displacement, const double *velocity, double *rest_times) {
    const gxsp_system *system = solver->system;
    size_t i;
    for (i = 0; system && i < count; i++) {
        const size_t before = origins[i] >> 1;
        if (before < system->model.n && gxsp_is_written(system, before, displacement + 3 * i, velocity + 3 * i))
            rest_times[i] = 0;
    }
}

GXFEM_API void gxs_solver_scene(const gxs_solver *solver, gxs_scene *scene) { *scene = solver->lasting.scene; }

/* Forgets what one step leaves to the next. What depends on the model alone stays. */
GXFEM_API void gxs_solver_resume(gxs_solver *solver, const gxs_scene *scene) {
    gxsp_system *system = solver->system;
    uint32_t p;
    solver->lasting.scene = *scene;
    memset(&solver->lasting.tempo, 0, sizeof solver->lasting.tempo);
    if (system && system->mesh.roots_known) gxsp_drop_system(solver);
    if (!solver->system) return;
    system->state.product_rate = -1;
    system->state.still_known = system->state.base_known = system->state.stepped = 0;
    system->state.guess_count = 0;
    system->leap.factor = 0;
    system->leap.limited = system->leap.known = 0;
    system->leap.served = 0;
    system->smoother.omega = 0;
    system->smoother.cautious = system->smoother.next_cautious = 0;
    system->coarse.rate = -1;
    system->coarse.stiffness = 0;
    system->coarse.worn = 0;
    system->coarse.served = system->coarse.read = 0;
    system->coarse.life = GXSP_LIFE;
    system->coarse.pace = system->coarse.read_nepers = 0;
    for (p = 0; p < system->model.component_count; p++) {
        gxsp_component *component = &system->model.components[p];
        component->state &= ~(GXSP_TOUCHED | GXSP_TOUCHES | GXSP_ASLEEP);
        component->forces[0] = component->forces[1] = 0;
        component->has_spring[0] = component->has_spring[1] = 0;
        component->has_pair[0] = component->has_pair[1] = 0;
    }
}

GXFEM_API gx_result gxs_solver_step(gxs_solver *solver, const gxs_step_desc *step, double *displacement,
                                    double *velocity, gxs_step_report *report, gx_failure *failure) {
    gxs_step_report own;
    gx_failure ignored;
    gx_result result;
    size_t n;
    failure = failure ? failure : &ignored;
    gxsp_end(failure, GX_OK);
    if (!solver) return gxsp_refuse(failure, "solver");
    if (!solver->system) return gxsp_fail(failure, GX_ERROR_SEQUENCE, "gxs_solver_set_model", SIZE_MAX);
    n = solver->system->model.n;
    if ((result = gxsp_check_all(step, n, solver->system->model.epoch, &solver->system->affine, failure)) != GX_OK ||
        (result = gxsp_check_vectors(step, n, displacement, velocity, solver->system->model.held, failure)) != GX_OK)
        return result;
    result = (step->quality > 0 ? gxsp_step_by_quality : gxsp_step_once)(solver, step, displacement, velocity, &own,
                                                                         failure);
    if (result == GX_OK && report) *report = own;
    return result;
}

/* NULL: all zero, which is right */
static gx_result gxsp_check_solver(const gxs_solver_desc *desc, gx_failure *failure) {
    if (!desc) return GX_OK;
    if (!desc->allocator.allocate != !desc->allocator.release ||
        (desc->allocator.reallocate && !desc->allocator.allocate))
        return gxsp_refuse(failure, "allocator");
    if ((int)desc->preconditioner < 0 || desc->preconditioner > GXS_VOLUME_RATIO)
        return gxsp_refuse(failure, "preconditioner");
    if ((int)desc->matrix < 0 || desc->matrix > GXS_MATRIX_ASSEMBLED) return gxsp_refuse(failure, "matrix");
    return GX_OK;
}

GXFEM_API gx_result gxs_solver_create(const gxs_solver_desc *desc, gxs_solver **solver, gx_failure *failure) {
    gx_allocator used = {NULL, NULL, NULL, NULL};
    gx_failure ignored;
    gxs_solver *made;
    failure = failure ? failure : &ignored;
    gxsp_end(failure, GX_OK);
    if (!solver) return gxsp_refuse(failure, "solver");
    if (gxsp_check_solver(desc, failure) != GX_OK) return failure->result;
    if (desc) used = desc->allocator;
    if (!used.allocate) {
        used.allocate = gxsp_malloc;
        used.release = gxsp_free;
    }
    made = (gxs_solver *)used.allocate(used.user, sizeof *made);
    if (!made) return gxsp_end(failure, GX_ERROR_MEMORY);
    memset(made, 0, sizeof *made);
    made->allocator = used;
    made->lasting.pool = gxsp_pool_make(&used);
    if (desc) {
        made->jobs = desc->jobs;
        made->preconditioner = desc->preconditioner;
        made->matrix = desc->matrix;
    }
    *solver = made;
    return GX_OK;
}

GXFEM_API void gxs_solver_destroy(gxs_solver *solver) {
    gx_allocator allocator;
    if (!solver) return;
    allocator = solver->allocator;
    gxsp_system_destroy(solver->system);
    gxsp_release_to(&solver->lasting.pool, NULL);
    allocator.release(allocator.user, solver, sizeof *solver);
}

/* >>single: a material at one deformation gradient ----------------------------------------------------------------- */

/* In: a material as the caller gives it and one F. Out: energy, stress or the projected Hessian times a direction, by
 * one lane of a block. Nothing is kept; no system is needed. */

static gxsp_state gxsp_single_state(const gxsp_material *material, const double *deformation) {
    gxsp_state state;
    int k;
    memset(&state, 0, sizeof state);
    state.mu[0] = material->mu;
    state.lambda[0] = material->lambda;
    for (k = 0; k < GXSP_LANES; k++) state.material[k] = material;
    for (k = 0; k < 9; k++) state.g[k][0] = deformation[k] - (k % 4 == 0 ? 1 : 0);
    return state;
}

GXFEM_API double gxs_material_energy(const gxs_material *material, const double *deformation) {
    const gxsp_material own = gxsp_material_make(material);
    gxsp_state state = gxsp_single_state(&own, deformation);
    gxsp_material_state(material->kind, &state);
    return state.energy[0];
}

GXFEM_API void gxs_material_stress(const gxs_material *material, const double *deformation, double *stress) {
    const gxsp_material own = gxsp_material_make(material);
    gxsp_state state = gxsp_single_state(&own, deformation);
    int k;
    gxsp_material_state(material->kind, &state);
    for (k = 0; k < 9; k++) stress[k] = state.p[k][0];
}

GXFEM_API void gxs_material_product(const gxs_material *material, const double *deformation, const double *direction,
                                    double *product) {
    const gxsp_material own = gxsp_material_make(material);
    gxsp_state state = gxsp_single_state(&own, deformation);
    gxsp_rest rest;
    gxsp_lanes gradients[9];
    gxsp_tangent tangent;
    gxsp_general general;
    gxsp_svd svd;
    gxsp_singles from[12], to[12];
    int k, c;
    memset(&rest, 0, sizeof rest);
    memset(&tangent, 0, sizeof tangent);
    memset(from, 0, sizeof from);
    memset(to, 0, sizeof to);
    rest.weight[0] = 1;
    memset(gradients, 0, sizeof gradients);
    /* u_i - u_0 are the columns of dF, the forces those of dP */
    gradients[0][0] = gradients[4][0] = gradients[8][0] = 1;
    (void)gxsp_tangent_begin(material->kind, &state, NULL, &svd);
    gxsp_tangent_make(material->kind, &rest, gradients, 1, 0, &state, &svd, &tangent, &general);
    for (k = 0; k < 3; k++)
        for (c = 0; c < 3; c++) from[3 + 3 * c + k][0] = (float)direction[3 * k + c];
    gxsp_kind_product(material->kind, &tangent, NULL, &general, 1, from, to);
    for (k = 0; k < 3; k++)
        for (c = 0; c < 3; c++) product[3 * k + c] = (double)to[3 + 3 * c + k][0];
}

#ifdef __cplusplus
}
#endif

#undef GXSP_LANES
#undef GXSP_CHUNK_BLOCKS
#undef GXSP_CHUNK
#undef GXSP_NEAR
#undef GXSP_NEAR_NUMBERS
#undef GXSP_EACH_LANE
#undef GXSP_RESTRICT
#undef GXSP_COLD
#undef GXSP_APART
#undef GXSP_INLINE
#undef GXSP_ROUNDING
#undef GXSP_ABSURD
#undef GXSP_PLACED
#undef GXSP_ARMIJO
#undef GXSP_TRIALS
#undef GXSP_STALLS
#undef GXSP_NONE
#undef GXSP_HELD
#undef GXSP_UNBALANCED
#undef GXSP_TOUCHED
#undef GXSP_TOUCHES
#undef GXSP_ASLEEP
#undef GXSP_COLLAPSED
#undef GXSP_STRETCHED
#undef GXSP_HEAVIEST
#undef GXSP_NUDGE
#undef GXSP_AHEAD
#undef GXSP_TANGENTS_AHEAD
#undef GXSP_RESTS_AHEAD
#undef GXSP_RANGE
#undef GXSP_LEAP_MASS
#undef GXSP_QUALITY_TIME
#undef GXSP_QUALITY_MIDPOINT
#undef GXSP_QUALITY_BDF2
#undef GXSP_QUALITY_MORE
#undef GXSP_QUALITY_EULER
#undef GXSP_QUALITY_COARSE
#undef GXSP_QUALITY_DEGREE
#undef GXSP_QUALITY_SUBSTEPS
#undef GXSP_QUALITY_EACH
#undef GXSP_QUALITY_FIRST
#undef GXSP_QUALITY_WAIT
#undef GXSP_QUALITY_FORGET
#undef GXSP_QUALITY_SLACK
#undef GXSP_QUALITY_HIDDEN
#undef GXSP_WORK_IMPLICIT
#undef GXSP_WORK_STEP
#undef GXSP_WORK_PRODUCT
#undef GXSP_QUALITY_SOFT
#undef GXSP_QUALITY_LEFT
#undef GXSP_QUALITY_LOOSE
#undef GXSP_QUALITY_ITERATIONS
#undef GXSP_WORK_QUICK
#undef GXSP_WORK_ITERATION
#undef GXSP_LEAP_FACTOR
#undef GXSP_LEAP_DEGREE
#undef GXSP_LEAP_DEGREES
#undef GXSP_LEAP_SUBSTEPS
#undef GXSP_LEAP_POWERS
#undef GXSP_LEAP_GAIN
#undef GXSP_LEAP_FORGET
#undef GXSP_LEAP_BLOCKS
#undef GXSP_LEAP_ALL
#undef GXSP_QUICK_AGE
#undef GXSP_QUICK_CUT
#undef GXSP_QUICK_TRIALS
#undef GXSP_QUICK_RETRY
#undef GXSP_LEAP_RAISE
#undef GXSP_LEAP_LAST
#undef GXSP_LEAP_ROWS
#undef GXSP_SPACING
#undef GXSP_CROWDED
#undef GXSP_AFFINE
#undef GXSP_COARSE
#undef GXSP_DIRTY
#undef GXSP_MULTIGRID_FROM
#undef GXSP_MULTIGRID_FROM_STIFF
#undef GXSP_STIFF_POISSON
#undef GXSP_FACTOR_COST
#undef GXSP_LEVELS
#undef GXSP_NESTED_COST
#undef GXSP_NESTED_FROM
#undef GXSP_GAINS
#undef GXSP_SETTLED
#undef GXSP_SHEETS_MOST
#undef GXSP_WIDEST
#undef GXSP_TIE
#undef GXSP_CALM
#undef GXSP_SHIFT
#undef GXSP_STIFFNESS
#undef GXSP_TINY
#undef GXSP_OMEGA
#undef GXSP_PAUSE
#undef GXSP_REMAKE
#undef GXSP_LIFE
#undef GXSP_AGEING
#undef GXSP_PATIENCE
#undef GXSP_READING
#undef GXSP_WORN
#undef GXSP_CHUNK_PARENTS
#undef GXSP_ALIGNMENT
#undef GXSP_FILTER
#undef GXSP_GROUPS
#undef GXSP_EACH
#undef GXSP_EACH_OF_TWO
#undef GXSP_GAIN
#undef GXSP_LIGHT
#undef GXSP_LIGHTER
#undef GXSP_FREE
#undef GXSP_BOUND_COST
#undef GXSP_BOUNDED
#undef GXSP_TOO_LONG
#undef GXSP_GAIN_TRIALS
#undef GXSP_INERTIA
#undef GXSP_INERTIA_PAIRED
#undef GXSP_PARALLEL
#undef GXSP_SUMS
#undef GXSP_IN
#undef GXSP_COLUMNS
#undef GXSP_SHUFFLES
#undef GXSP_AVX
#undef GXSP_DOUBLES
#undef GXSP_LOAD
#undef GXSP_STORE
#undef GXSP_FILLED
#undef GXSP_PLUS
#undef GXSP_TIMES
#undef GXSP_ZIP_LOW
#undef GXSP_ZIP_HIGH
#undef GXSP_JOIN_LOW
#undef GXSP_JOIN_HIGH
#undef GXSP_HALVES
#undef GXSP_ADD_LOW
#undef GXSP_ADD_HIGH
#undef GXSP_LOAD_PAIR
#undef GXSP_STORE_PAIR
#undef GXSP_EVENS
#undef GXSP_ODDS
#undef GXSP_NARROW
#undef GXSP_NO_DOUBLES
#undef GXSP_LOAD_DOUBLES
#undef GXSP_WIDEN
#undef GXSP_NINE_SUMS
#undef GXSP_NINE_DOTS
#undef GXSP_ADD_PRODUCT
#undef GXSP_SUM_DOUBLES
#undef GXSP_NESTED_SLACK
#undef GXSP_AFFINE_TASK
#undef GXSP_AFFINE_ROUND
#undef GXSP_STICKS
#ifdef GXFEM_SCALAR
#pragma clang attribute pop
#endif
#endif /* GXFEM_SOLVE_IMPLEMENTED */
