/* gxfem_solve.h 0.1: implicit time steps of hyperelastic tetrahedra, matrix-free. Part of gxfem.
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
 *             1.0 / 6, {17, 8, 8, 8, 17, 8, 8, 17, 8, 17}};                         // m3; kg
 *         double displacement[12] = {0}, velocity[12] = {0};
 *         gxs_model model = {4, &element, 1, 1e6, 0.4, NULL};
 *         gxs_step_desc step = {1.0 / 30, {0, 0, -9.81}, NULL, 0, 0, 0, 0};
 *         gxs_solver *solver = NULL;
 *         gx_result result = gxs_solver_create(NULL, &solver);
 *         if (result == GX_OK)
 *             result = gxs_solver_step(solver, &model, &step, displacement, velocity, NULL, NULL);
 *         gxs_solver_destroy(solver);
 *         return (int)result;
 *     }
 *
 * CONTENTS (search for the anchors)
 *   >>shared      result codes, allocator          >>svd         stretches and rotations of F
 *   >>types       elements, model, step, report    >>tangent     projected Hessian of one F
 *   >>functions   the API                          >>element     element passes: energy, force, product
 *   >>platform    finite by bits, checks           >>pieces      free pieces and their translations
 *   >>memory      allocator, workspace             >>cg          preconditioner, conjugate gradients
 *   >>material    stable neo-Hookean               >>newton      line search, Newton, the step
 *
 * WHAT IT DOES. A step of length h is the minimum over the displacements u of the incremental potential
 *
 *     E(u) = |u - u_n - h v_n|_M^2 / (2 h^2) + U(u) - f . u        GXFEM Eq. 10 divided by h^2; joule
 *
 * M: mass, U: elastic energy, f = M g + nodal forces: a linear term, so that M is never inverted. Then
 * v = (u - u_n) / h. E is minimised by Newton's method with a line search on E. The Hessian of every element
 * is projected to the nearest positive semi-definite one in closed form (analytic eigensystem); its products
 * are matrix-free. The linear systems go to conjugate gradients with 3x3 block-Jacobi.
 * Newton starts at u_n + h v_n; should it end above E(u_n), it is run again from u_n: E(u) <= E(u_n) always, so a step cannot
 * blow up. Every free piece (copies joined by elements, none of them held) then moves as
 * a whole so that its momentum balances, and the later iterates leave its momentum alone: the momentum of
 * every free piece is right to rounding whatever the tolerances are, and free fall takes no iteration.
 * Residuals are measured twice, both times scaled by the block diagonal D of the Hessian: in energy,
 * sqrt(sum r_i . D_i^-1 r_i), and in displacement, sqrt(sum |D_i^-1 r_i|^2). The second sees a piece of 1e-12 of its
 * neighbour's volume as well as the neighbour.
 *
 * WHAT IT DOES NOT DO. No cutting and no meshes: it sees elements of four copies. No contact, no friction, no
 * damping but backward Euler's own, no moving supports (change the displacement of a held copy between steps).
 * No threads; every pass is a loop over blocks of elements, which is where a job hook will go. One material and
 * one preconditioner so far: a material is the functions of >>material, a preconditioner those of >>cg.
 *
 * LIMITS. poisson in [0, 0.5); copies and elements below 2^32. Work is in doubles. Workspace: about 480 bytes per
 * copy and 430 per element. The material can invert without a failure and comes back by itself; an element collapsed to a
 * point exactly has no elastic force (F = 0 is a stationary point of its energy). Same input, same binary: same
 * bits. Nothing here needs isnan or infinities: it is right under -ffast-math, where sums round otherwise.
 *
 * REFERENCES. GXFEM: Generalized eXtended Finite Element Method for Deformable Cutting via Boolean Operations,
 * 2024. Smith 2018: Smith, de Goes, Kim, Stable Neo-Hookean Flesh Simulation, ACM Trans. Graph. 37(2), 2018.
 *
 * MACROS. GXFEM_SOLVE_IMPLEMENTATION or GXFEM_IMPLEMENTATION: the code comes here. GXFEM_STATIC: all static.
 */
#ifndef GXFEM_SOLVE_INCLUDED
#define GXFEM_SOLVE_INCLUDED

/* >>shared: this block is the same in every gxfem header; `make lint` compares the copies */
#ifndef GXFEM_SHARED_INCLUDED
#define GXFEM_SHARED_INCLUDED
#include <stddef.h>
#include <stdint.h>

/* GXFEM_STATIC makes every function private to the file that includes the headers */
#ifdef GXFEM_STATIC
#define GXFEM_API static inline
#else
#define GXFEM_API extern
#endif

/* What a function that can fail returns. On anything but GX_OK its inputs are as they were. */
typedef enum gx_result {
    GX_OK = 0,
    GX_ERROR_ARGUMENT,      /* a required pointer is NULL, a required field is zero or senseless */
    GX_ERROR_MEMORY,        /* the allocator returned NULL */
    GX_ERROR_NOT_FINITE,    /* a coordinate or parameter is NaN or infinite */
    GX_ERROR_RANGE,         /* a coordinate is too large or too small beside the others (see "limits") */
    GX_ERROR_INDEX,         /* an index points outside its array */
    GX_ERROR_EMPTY,         /* no elements, no nodes or no triangles */
    GX_ERROR_INVERTED,      /* an element has negative volume */
    GX_ERROR_FLAT,          /* an element has no volume */
    GX_ERROR_OVERLAP,       /* an element face is shared by more than two elements, or by two on one side */
    GX_ERROR_NOT_CLOSED,    /* a solid's surface has a boundary, or its triangles are not oriented alike */
    GX_ERROR_LIMIT,         /* more objects than 32-bit indices can name, or a caller's limit is reached */
    GX_ERROR_DIVERGED       /* a time step found no finite state of lower energy */
} gx_result;

/* What went wrong, and where: index of the node, element, triangle or copy concerned. */
typedef struct gx_failure {
    gx_result result;
    size_t index;           /* SIZE_MAX: no single object is to blame */
    size_t surface;         /* of a cut: which of its surfaces; else SIZE_MAX */
} gx_failure;

/* Where memory comes from. Zero-initialised: malloc and free. */
typedef struct gx_allocator {
    void *(*allocate)(void *user, size_t size);             /* NULL when there is none; size is never 0 */
    void (*release)(void *user, void *memory, size_t size); /* size as it was allocated; memory is never NULL */
    void *user;
} gx_allocator;
#endif /* GXFEM_SHARED_INCLUDED */

#ifdef __cplusplus
extern "C" {
#endif

/* >>types */

/* A linear tetrahedron, or the part of one that a cut has left. */
typedef struct gxs_element {
    uint32_t copy[4];       /* whose displacement each corner follows; below copy_count */
    double gradient[4][3];  /* of the four shape functions, 1/m; row 0 is minus the sum of the others and not read */
    double weight;          /* volume, m3; 0 or more */
    double mass[10];        /* rho int N_i N_j, kg, symmetric 4x4 block: 00 01 02 03 11 12 13 22 23 33 */
} gxs_element;

/* Borrowed for the time of a call. */
typedef struct gxs_model {
    size_t copy_count;
    const gxs_element *elements; /* element_count */
    size_t element_count;
    double young;           /* Pa, above 0 */
    double poisson;         /* 0 <= poisson < 0.5 */
    const uint8_t *held;    /* copy_count flags: not 0 keeps the copy's displacement; NULL: none is held */
} gxs_model;

typedef struct gxs_step_desc {
    double dt;                  /* s, above 0 */
    double gravity[3];          /* m/s2 */
    const double *forces;       /* copy_count x 3, N; NULL: none */
    uint32_t newton_iterations; /* at most so many; 0: 1 */
    double newton_tolerance;    /* stop at this residual (see gxs_step_report); 0: run all */
    uint32_t cg_iterations;     /* per Newton iteration, at most; 0: 1000 */
    double cg_tolerance;        /* reduction of the residual by each linear solve; 0: 1e-2 */
} gxs_step_desc;

typedef struct gxs_step_report {
    uint32_t newton_iterations; /* done; 0 when the start was in balance to rounding */
    uint32_t cg_iterations;     /* sum over Newton iterations */
    uint32_t line_search_steps; /* step lengths tried, sum over Newton iterations */
    double residual;            /* |load - inertia - elastic| / (|load| + |inertia| + |elastic|) on the copies not held,
                                   the larger of the two measures (see above) */
    double energy;              /* E at the end, J, up to a constant: the load on held copies */
} gxs_step_report;

/* Workspace of steps: grows to the largest model it has seen; one thread at a time. */
typedef struct gxs_solver gxs_solver;

/* >>functions
 * Those that return a gx_result check all they read: GX_ERROR_ARGUMENT, _EMPTY, _LIMIT, _INDEX (index: element),
 * _NOT_FINITE (index: element or copy), _INVERTED (weight below 0; index: element). Outputs are written on GX_OK only. */

/* Advances displacement (m) and velocity (m/s), both copy_count x 3 and not overlapping, by one step.
 * Held copies, and copies without an element of any weight or mass, keep their displacement and get velocity 0.
 * report and failure may be NULL. GX_ERROR_MEMORY and GX_ERROR_DIVERGED are possible too; displacement and velocity are
 * then unchanged. A residual above newton_tolerance when the iterations are used up is no error: see the report.
 * No allocation unless the model is larger than any before it. */
GXFEM_API gx_result gxs_solver_step(gxs_solver *solver, const gxs_model *model, const gxs_step_desc *step,
                                    double *displacement, double *velocity, gxs_step_report *report,
                                    gx_failure *failure);

/* allocator: copied; NULL: malloc and free. Memory must be aligned as malloc aligns it. */
GXFEM_API gx_result gxs_solver_create(const gx_allocator *allocator, gxs_solver **solver);
GXFEM_API void gxs_solver_destroy(gxs_solver *solver); /* NULL is allowed */

/* Assembled forms, for tests and benches: no held copies, no time. Vectors are copy_count x 3.
 * energy: U, J. gradient: dU/du, N. hessian_product: projected Hessian of U at displacement times direction, N.
 * mass_product: M times direction. The output may not overlap an input. */
GXFEM_API gx_result gxs_model_energy(const gxs_model *model, const double *displacement, double *energy);
GXFEM_API gx_result gxs_model_gradient(const gxs_model *model, const double *displacement, double *gradient);
GXFEM_API gx_result gxs_model_hessian_product(const gxs_model *model, const double *displacement,
                                              const double *direction, double *product);
GXFEM_API gx_result gxs_model_mass_product(const gxs_model *model, const double *direction, double *product);

/* The material at one deformation gradient F (3x3 by rows, unchecked): energy density, J/m3, 0 at rest; first Piola-Kirchhoff
 * stress P = d energy / dF, Pa; projected Hessian dP/dF times direction, Pa. */
GXFEM_API double gxs_stable_neo_hookean_energy(double young, double poisson, const double *deformation);
GXFEM_API void gxs_stable_neo_hookean_stress(double young, double poisson, const double *deformation, double *stress);
GXFEM_API void gxs_stable_neo_hookean_product(double young, double poisson, const double *deformation,
                                              const double *direction, double *product);

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

#include <math.h>
#include <stdlib.h>
#include <string.h>

#ifdef __cplusplus
extern "C" {
#endif

/* elements side by side in a block: whole vectors on every instruction set up to 512 bits */
#define GXSP_LANES 8

/* A residual below this (about 50 units in the last place) is rounding: no iteration can lower it. */
#define GXSP_ROUNDING 1e-14

/* Sufficient decrease in the line search, share of what the slope promises [Nocedal and Wright, Numerical Optimization]. */
#define GXSP_ARMIJO 1e-4

/* Line search: at worst each trial halves the step; after 60 nothing of it is left. */
#define GXSP_TRIALS 60

/* piece of a copy that belongs to no free piece */
#define GXSP_NO_PIECE UINT32_MAX

/* >>platform: comparisons with NaN mean nothing under -ffast-math, so finiteness is read off the bits */

static int gxsp_finite(double value)
{
    uint64_t bits;
    memcpy(&bits, &value, sizeof bits);
    return ((bits >> 52) & 0x7ff) != 0x7ff;
}

/* Index of the first value that is NaN or infinite; count if there is none. */
static size_t gxsp_first_not_finite(const double *values, size_t count)
{
    size_t i;
    for (i = 0; i < count; ++i)
        if (!gxsp_finite(values[i]))
            break;
    return i;
}

static gx_result gxsp_fail(gx_failure *failure, gx_result result, size_t index)
{
    failure->result = result;
    failure->index = index;
    failure->surface = SIZE_MAX;
    return result;
}

/* 3-vectors a[3 count], b[3 count]; three sums, so that no addition waits for the one before it */
static double gxsp_dot(const double *a, const double *b, size_t count)
{
    double x = 0, y = 0, z = 0;
    size_t i;
    for (i = 0; i < count; ++i) {
        x += a[3 * i] * b[3 * i];
        y += a[3 * i + 1] * b[3 * i + 1];
        z += a[3 * i + 2] * b[3 * i + 2];
    }
    return x + y + z;
}

/* index of entry (i, j), i <= j, of a symmetric 3x3 stored 00 01 02 11 12 22 */
static int gxsp_packed3(int i, int j)
{
    return i * (5 - i) / 2 + j;
}

static gx_result gxsp_check_element(const gxs_element *element, size_t copy_count, size_t index, gx_failure *failure)
{
    int i;
    for (i = 0; i < 4; ++i)
        if (element->copy[i] >= copy_count)
            return gxsp_fail(failure, GX_ERROR_INDEX, index);
    if (gxsp_first_not_finite(&element->gradient[1][0], 9) < 9 || !gxsp_finite(element->weight) ||
        gxsp_first_not_finite(element->mass, 10) < 10)
        return gxsp_fail(failure, GX_ERROR_NOT_FINITE, index);
    if (element->weight < 0)
        return gxsp_fail(failure, GX_ERROR_INVERTED, index);
    if (element->mass[0] < 0 || element->mass[4] < 0 || element->mass[7] < 0 || element->mass[9] < 0)
        return gxsp_fail(failure, GX_ERROR_ARGUMENT, index);
    return GX_OK;
}

static gx_result gxsp_check_model(const gxs_model *model, gx_failure *failure)
{
    size_t e;
    if (!model || (!model->elements && model->element_count > 0))
        return gxsp_fail(failure, GX_ERROR_ARGUMENT, SIZE_MAX);
    if (model->copy_count == 0 || model->element_count == 0)
        return gxsp_fail(failure, GX_ERROR_EMPTY, SIZE_MAX);
    /* 1024: no array of the workspace takes more bytes per object, so sizes cannot overflow */
    if (model->copy_count >= UINT32_MAX || model->element_count >= UINT32_MAX ||
        model->copy_count >= SIZE_MAX / 1024 || model->element_count >= SIZE_MAX / 1024)
        return gxsp_fail(failure, GX_ERROR_LIMIT, SIZE_MAX);
    if (!gxsp_finite(model->young) || !gxsp_finite(model->poisson))
        return gxsp_fail(failure, GX_ERROR_NOT_FINITE, SIZE_MAX);
    if (model->young <= 0 || model->poisson < 0 || model->poisson >= 0.5)
        return gxsp_fail(failure, GX_ERROR_ARGUMENT, SIZE_MAX);
    for (e = 0; e < model->element_count; ++e) {
        gx_result result = gxsp_check_element(&model->elements[e], model->copy_count, e, failure);
        if (result != GX_OK)
            return result;
    }
    return GX_OK;
}

static gx_result gxsp_check_vector(const double *vector, size_t copy_count, gx_failure *failure)
{
    size_t i;
    if (!vector)
        return gxsp_fail(failure, GX_ERROR_ARGUMENT, SIZE_MAX);
    i = gxsp_first_not_finite(vector, 3 * copy_count);
    return i < 3 * copy_count ? gxsp_fail(failure, GX_ERROR_NOT_FINITE, i / 3) : GX_OK;
}

static gx_result gxsp_check_step(const gxs_step_desc *step, gx_failure *failure)
{
    if (!step)
        return gxsp_fail(failure, GX_ERROR_ARGUMENT, SIZE_MAX);
    if (!gxsp_finite(step->dt) || gxsp_first_not_finite(step->gravity, 3) < 3 || !gxsp_finite(step->newton_tolerance) ||
        !gxsp_finite(step->cg_tolerance))
        return gxsp_fail(failure, GX_ERROR_NOT_FINITE, SIZE_MAX);
    if (step->dt <= 0 || step->newton_tolerance < 0 || step->cg_tolerance < 0)
        return gxsp_fail(failure, GX_ERROR_ARGUMENT, SIZE_MAX);
    if (step->dt < 1e-100 || step->dt > 1e100) /* dt^2 and 1 / dt^2 must be numbers */
        return gxsp_fail(failure, GX_ERROR_RANGE, SIZE_MAX);
    return GX_OK;
}

/* >>memory */

/* GXSP_LANES elements in the form that products read; lane l of every array is one element.
 * Lanes beyond the last element are zero and name copy 0, to which they add zeros. */
typedef struct gxsp_block {
    double frame[9][GXSP_LANES];    /* U of F = U S V^T, by rows */
    double gradient[9][GXSP_LANES]; /* shape function gradients 1..3 times V, by rows, 1/m */
    double stretch[6][GXSP_LANES];  /* weight x projected Hessian: stretches; J */
    double even[3][GXSP_LANES];     /* of the off-diagonal pairs (12), (20), (01): to themselves; J */
    double odd[3][GXSP_LANES];      /* and to each other; J */
    double mass[10][GXSP_LANES];    /* mass / dt^2, kg/s2 */
    uint32_t copy[4][GXSP_LANES];
} gxsp_block;

/* All arrays of a step, cut from one allocation. n: copy_count. Vectors are n x 3 unless said. */
typedef struct gxsp_work {
    double *base;         /* displacement at the start of the step */
    double *target;       /* where inertia alone leads: base + dt v */
    double *load;         /* gravity and nodal forces, N */
    double *current;      /* displacement: Newton's iterate */
    double *trial;        /* displacement: tried by the line search */
    double *inertia;      /* M (current - target) / dt^2, N */
    double *elastic;      /* dU/du at current, N */
    double *residual;     /* load - inertia - elastic; conjugate gradients use it up */
    double *direction;    /* the solution of the linear system */
    double *search;       /* conjugate gradients: search direction */
    double *scaled;       /* preconditioned residual; scratch */
    double *product;      /* Hessian times search; scratch */
    double *diagonal;     /* n x 6: block diagonal, then its inverse; 0 for fixed copies */
    double *lumped;       /* n: row sums of the mass / dt^2 */
    double *piece_sum;    /* piece_count x 4 (room for n): sums over pieces; the last is that of lumped */
    double *energy;       /* element_count: weight x energy density at current, J */
    gxsp_block *blocks;   /* block_count */
    uint32_t *piece;      /* n: number of the free piece, or GXSP_NO_PIECE */
    uint32_t *parent;     /* n: of the forest that joins copies to pieces */
    uint8_t *fixed;       /* n: held, or without an element */
} gxsp_work;

struct gxs_solver {
    gx_allocator allocator;
    unsigned char *memory; /* size bytes; NULL before the first step */
    size_t size;
};

static void *gxsp_malloc(void *user, size_t size)
{
    (void)user;
    return malloc(size);
}

static void gxsp_free(void *user, void *memory, size_t size)
{
    (void)user;
    (void)size;
    free(memory);
}

static size_t gxsp_block_count(size_t element_count)
{
    return (element_count + GXSP_LANES - 1) / GXSP_LANES;
}

/* Bytes of the workspace: 12 vectors and 6 + 1 + 4 doubles, two indices and a flag per copy. */
static size_t gxsp_work_size(size_t n, size_t element_count)
{
    return n * ((12 * 3 + 11) * sizeof(double) + 2 * sizeof(uint32_t) + 1) + element_count * sizeof(double) +
           gxsp_block_count(element_count) * sizeof(gxsp_block);
}

static double *gxsp_take(double **cursor, size_t count)
{
    double *taken = *cursor;
    *cursor += count;
    return taken;
}

/* The order is that of alignment: doubles, blocks (doubles first, whole doubles long), indices, flags. */
static void gxsp_work_place(gxsp_work *work, unsigned char *memory, size_t n, size_t element_count)
{
    double *cursor = (double *)(void *)memory;
    double **vectors[12];
    int i;
    vectors[0] = &work->base, vectors[1] = &work->target, vectors[2] = &work->load, vectors[3] = &work->current;
    vectors[4] = &work->trial, vectors[5] = &work->inertia, vectors[6] = &work->elastic, vectors[7] = &work->residual;
    vectors[8] = &work->direction, vectors[9] = &work->search, vectors[10] = &work->scaled;
    vectors[11] = &work->product;
    for (i = 0; i < 12; ++i)
        *vectors[i] = gxsp_take(&cursor, 3 * n);
    work->diagonal = gxsp_take(&cursor, 6 * n);
    work->lumped = gxsp_take(&cursor, n);
    work->piece_sum = gxsp_take(&cursor, 4 * n);
    work->energy = gxsp_take(&cursor, element_count);
    work->blocks = (gxsp_block *)(void *)cursor;
    work->piece = (uint32_t *)(void *)(work->blocks + gxsp_block_count(element_count));
    work->parent = work->piece + n;
    work->fixed = (uint8_t *)(work->parent + n);
}

/* Makes room for a model. A quarter more than needed, since cuts add a few copies at a time. */
static gx_result gxsp_reserve(gxs_solver *solver, size_t n, size_t element_count)
{
    size_t size = gxsp_work_size(n, element_count);
    unsigned char *memory;
    if (size <= solver->size)
        return GX_OK;
    size += size / 4;
    memory = (unsigned char *)solver->allocator.allocate(solver->allocator.user, size);
    if (!memory)
        return GX_ERROR_MEMORY;
    if (solver->memory)
        solver->allocator.release(solver->allocator.user, solver->memory, solver->size);
    solver->memory = memory;
    solver->size = size;
    return GX_OK;
}

/* >>material: stable neo-Hookean, with the origin barrier [Smith 2018]. An isotropic material is what the functions here say.
 *
 *   psi = mu/2 (Ic - 3) + lambda/2 (J - alpha)^2 - mu/2 log(Ic + 1) + constant,   Ic = |F|^2, J = det F,
 *   alpha = 1 + 3/4 mu/lambda: no stress at rest.   mu = 4/3 mu', lambda = lambda' + 5/6 mu': in small strain the Lame
 *   constants are mu', lambda' [Smith 2018].
 *
 * Written in G = F - 1 so that nothing cancels near rest, with t = tr G, i = Ic - 3, j = J - 1:
 *
 *   psi = 3/8 mu (|G|^2 + tr G^2 - t^2 - 2 det G) + mu/2 (x - log(1 + x)) + lambda/2 j^2,   x = i/4
 *   P   = 3/4 mu (G + G^T - t 1 - cof G) + mu/4 i/(Ic + 1) F + lambda j cof F
 */
typedef struct gxsp_material {
    double mu, lambda; /* Pa */
} gxsp_material;

static gxsp_material gxsp_material_make(double young, double poisson)
{
    double shear = young / (2 * (1 + poisson));
    double lame = young * poisson / ((1 + poisson) * (1 - 2 * poisson));
    gxsp_material material;
    material.mu = 4.0 / 3 * shear;
    material.lambda = lame + 5.0 / 6 * shear;
    return material;
}

/* Cofactors of a 3x3: the derivative of its determinant. */
static void gxsp_cofactors(const double *a, double *cofactors)
{
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

/* The invariants of F = 1 + G as differences from rest. */
typedef struct gxsp_invariants {
    double trace;       /* t = tr G */
    double square;      /* |G|^2 */
    double determinant; /* det G */
    double i, j;        /* |F|^2 - 3, det F - 1 */
} gxsp_invariants;

/* cofactors: of G */
static gxsp_invariants gxsp_invariants_make(const double *g, const double *cofactors)
{
    gxsp_invariants of;
    int k;
    of.trace = g[0] + g[4] + g[8];
    of.square = 0;
    for (k = 0; k < 9; ++k)
        of.square += g[k] * g[k];
    of.determinant = g[0] * cofactors[0] + g[1] * cofactors[1] + g[2] * cofactors[2];
    of.i = 2 * of.trace + of.square;
    of.j = of.trace + (cofactors[0] + cofactors[4] + cofactors[8]) + of.determinant;
    return of;
}

/* x - log(1 + x) for x >= -3/4, without cancellation: below 1/100 by its series, whose next term is below 1e-18 x^2 */
static double gxsp_log_rest(double x)
{
    if (x > 0.01 || x < -0.01)
        return x - log1p(x);
    return x * x * (1.0 / 2 - x * (1.0 / 3 - x * (1.0 / 4 - x * (1.0 / 5 - x * (1.0 / 6 - x * (1.0 / 7 - x *
           (1.0 / 8 - x * (1.0 / 9 - x / 10))))))));
}

/* psi at 1 + G, J/m3. noise: size of the terms whose rounding it carries. */
static double gxsp_material_energy(const gxsp_material *material, const double *g, double *noise)
{
    double cofactors[9];
    gxsp_invariants of;
    double second, square_trace, volume;
    gxsp_cofactors(g, cofactors);
    of = gxsp_invariants_make(g, cofactors);
    square_trace = g[0] * g[0] + g[4] * g[4] + g[8] * g[8] + 2 * (g[1] * g[3] + g[2] * g[6] + g[5] * g[7]);
    second = of.square + square_trace - of.trace * of.trace - 2 * of.determinant;
    volume = 0.5 * material->lambda * of.j * of.j;
    *noise = material->mu * of.square + volume;
    return 0.375 * material->mu * second + 0.5 * material->mu * gxsp_log_rest(0.25 * of.i) + volume;
}

/* P at 1 + G, Pa */
static void gxsp_material_stress(const gxsp_material *material, const double *g, double *stress)
{
    double cofactors[9], rest, growth, pressure;
    gxsp_invariants of;
    int r, c;
    gxsp_cofactors(g, cofactors);
    of = gxsp_invariants_make(g, cofactors);
    rest = 0.75 * material->mu;
    growth = 0.25 * material->mu * of.i / (of.i + 4);
    pressure = material->lambda * of.j;
    for (r = 0; r < 3; ++r)
        for (c = 0; c < 3; ++c) {
            double unit = r == c ? 1 : 0, own = g[3 * r + c], turned = g[3 * c + r], cofactor = cofactors[3 * r + c];
            /* cof F = (1 + t) 1 - G^T + cof G */
            stress[3 * r + c] = rest * (own + turned - of.trace * unit - cofactor) + growth * (own + unit) +
                                pressure * ((1 + of.trace) * unit - turned + cofactor);
        }
}

/* Hessian of psi at F = diag(s), s signed [eigensystem of Smith 2018].
 * stretch: packed 3x3, d2 psi / ds_i ds_j. The pair (F_ij, F_ji), k the third index: even = d2 psi / dF_ij^2,
 * odd = d2 psi / dF_ij dF_ji; its eigenvalues are even + odd and even - odd. Everything else is 0. */
static void gxsp_material_hessian(const gxsp_material *material, const double *s, double *stretch, double *even,
                                  double *odd)
{
    double square = s[0] * s[0] + s[1] * s[1] + s[2] * s[2];
    double direct = material->mu * (square / (square + 1));
    double along = 2 * material->mu / (square + 1) / (square + 1);
    double volume = s[0] * s[1] * s[2] - 1;
    double pressure = material->lambda * volume - 0.75 * material->mu; /* lambda (J - alpha) */
    double area[3];
    int i, j;
    area[0] = s[1] * s[2], area[1] = s[2] * s[0], area[2] = s[0] * s[1];
    for (i = 0; i < 3; ++i) {
        for (j = i; j < 3; ++j)
            stretch[gxsp_packed3(i, j)] = along * s[i] * s[j] + material->lambda * area[i] * area[j] +
                                          (i == j ? direct : pressure * s[3 - i - j]);
        even[i] = direct;
        odd[i] = -pressure * s[i];
    }
}

/* >>svd */

/* Turns columns i and j of the 3x3s b and v so that those of b become orthogonal; 0 if they were, to 1e-10: this is an error
 * of the Hessian, not of forces, and cannot cost it its sign, since any U and V give a congruence. */
static int gxsp_orthogonalise(double *b, double *v, int i, int j)
{
    double alpha = 0, beta = 0, gamma = 0, gap, t, c, s;
    int k;
    for (k = 0; k < 9; k += 3) {
        alpha += b[k + i] * b[k + i];
        beta += b[k + j] * b[k + j];
        gamma += b[k + i] * b[k + j];
    }
    if (gamma * gamma <= 1e-20 * alpha * beta)
        return 0;
    gap = beta - alpha;
    t = 2 * gamma / (fabs(gap) + sqrt(gap * gap + 4 * gamma * gamma));
    t = gap < 0 ? -t : t;
    c = 1 / sqrt(1 + t * t);
    s = c * t;
    for (k = 0; k < 9; k += 3) {
        double bi = b[k + i], bj = b[k + j], vi = v[k + i], vj = v[k + j];
        b[k + i] = c * bi - s * bj, b[k + j] = s * bi + c * bj;
        v[k + i] = c * vi - s * vj, v[k + j] = s * vi + c * vj;
    }
    return 1;
}

static void gxsp_swap_columns(double *b, double *v, int i, int j)
{
    int k;
    for (k = 0; k < 9; k += 3) {
        double bi = b[k + i], vi = v[k + i];
        b[k + i] = b[k + j], b[k + j] = -bi; /* a quarter turn, so that det V stays 1 */
        v[k + i] = v[k + j], v[k + j] = -vi;
    }
}

static double gxsp_column_dot(const double *a, int i, const double *b, int j)
{
    return a[i] * b[j] + a[3 + i] * b[3 + j] + a[6 + i] * b[6 + j];
}

/* Columns of b are orthogonal, longest first. U: their directions, completed to a rotation where they vanish. */
static void gxsp_frame(const double *b, double *u)
{
    double first = sqrt(gxsp_column_dot(b, 0, b, 0)), along, second;
    int k;
    for (k = 0; k < 3; ++k)
        u[3 * k] = first > 0 ? b[3 * k] / first : (k == 0 ? 1 : 0);
    along = gxsp_column_dot(u, 0, b, 1);
    for (k = 0; k < 3; ++k)
        u[3 * k + 1] = b[3 * k + 1] - along * u[3 * k];
    second = sqrt(gxsp_column_dot(u, 1, u, 1));
    if (second <= 1e-14 * first) { /* a line: any direction across will do; the axis least along it */
        int least = fabs(u[0]) <= fabs(u[3]) && fabs(u[0]) <= fabs(u[6]) ? 0 : fabs(u[3]) <= fabs(u[6]) ? 1 : 2;
        double part = u[3 * least];
        for (k = 0; k < 3; ++k)
            u[3 * k + 1] = (k == least ? 1 : 0) - part * u[3 * k];
        second = sqrt(gxsp_column_dot(u, 1, u, 1));
    }
    for (k = 0; k < 3; ++k)
        u[3 * k + 1] /= second;
    u[2] = u[3] * u[7] - u[6] * u[4];
    u[5] = u[6] * u[1] - u[0] * u[7];
    u[8] = u[0] * u[4] - u[3] * u[1];
}

/* F = U diag(s) V^T with rotations U, V (determinants 1) and s[2] signed, by one-sided Jacobi. */
static void gxsp_svd(const double *f, double *u, double *s, double *v)
{
    static const double unit[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1};
    double b[9], norm[3];
    int sweep, k;
    memcpy(b, f, sizeof b);
    memcpy(v, unit, sizeof unit);
    for (sweep = 0; sweep < 16; ++sweep) { /* 3 to 4 suffice but for extreme F */
        int turned = gxsp_orthogonalise(b, v, 0, 1);
        turned |= gxsp_orthogonalise(b, v, 0, 2);
        turned |= gxsp_orthogonalise(b, v, 1, 2);
        if (!turned)
            break;
    }
    for (k = 0; k < 3; ++k)
        norm[k] = gxsp_column_dot(b, k, b, k);
    if (norm[1] > norm[0])
        gxsp_swap_columns(b, v, 0, 1), norm[1] = norm[0];
    if (norm[2] > norm[1])
        gxsp_swap_columns(b, v, 1, 2);
    if (gxsp_column_dot(b, 1, b, 1) > gxsp_column_dot(b, 0, b, 0))
        gxsp_swap_columns(b, v, 0, 1);
    gxsp_frame(b, u);
    for (k = 0; k < 3; ++k)
        s[k] = gxsp_column_dot(u, k, b, k);
}

/* >>tangent */

/* Projected Hessian of one F = U S V^T: dP = U (h : U^T dF V) V^T. */
typedef struct gxsp_tangent {
    double u[9], v[9];
    double stretch[6], even[3], odd[3]; /* as in gxsp_material_hessian, semi-definite; Pa */
} gxsp_tangent;

/* Is the packed 3x3 positive definite? (leading minors by elimination) */
static int gxsp_definite3(const double *a)
{
    double b, c, d, e;
    if (a[0] <= 0)
        return 0;
    b = a[1] / a[0];
    c = a[2] / a[0];
    d = a[3] - b * a[1];
    if (d <= 0)
        return 0;
    e = a[4] - b * a[2];
    return a[5] - c * a[2] - e * e / d > 0;
}

/* One Jacobi turn of the symmetric 3x3 a (by rows) that makes a_ij zero; the turn also goes to the columns of v. */
static void gxsp_diagonalise(double *a, double *v, int i, int j)
{
    double zeta, t, c, s;
    int k;
    if (a[3 * i + j] * a[3 * i + j] <= 1e-32 * fabs(a[4 * i] * a[4 * j]))
        return;
    zeta = (a[4 * j] - a[4 * i]) / (2 * a[3 * i + j]);
    t = (zeta < 0 ? -1 : 1) / (fabs(zeta) + sqrt(1 + zeta * zeta));
    c = 1 / sqrt(1 + t * t);
    s = c * t;
    for (k = 0; k < 3; ++k) {
        double ai = a[3 * i + k], aj = a[3 * j + k];
        a[3 * i + k] = c * ai - s * aj, a[3 * j + k] = s * ai + c * aj;
    }
    for (k = 0; k < 9; k += 3) {
        double ai = a[k + i], aj = a[k + j], vi = v[k + i], vj = v[k + j];
        a[k + i] = c * ai - s * aj, a[k + j] = s * ai + c * aj;
        v[k + i] = c * vi - s * vj, v[k + j] = s * vi + c * vj;
    }
}

/* Replaces the packed symmetric 3x3 by the nearest semi-definite one: negative eigenvalues become 0. */
static void gxsp_project3(double *packed)
{
    double a[9], v[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1};
    int sweep, i, j, k;
    if (gxsp_definite3(packed))
        return;
    for (i = 0; i < 3; ++i)
        for (j = i; j < 3; ++j)
            a[3 * i + j] = a[3 * j + i] = packed[gxsp_packed3(i, j)];
    for (sweep = 0; sweep < 8; ++sweep) { /* converges quadratically: 5 reach rounding */
        gxsp_diagonalise(a, v, 0, 1);
        gxsp_diagonalise(a, v, 0, 2);
        gxsp_diagonalise(a, v, 1, 2);
    }
    for (i = 0; i < 3; ++i)
        for (j = i; j < 3; ++j) {
            double sum = 0;
            for (k = 0; k < 3; ++k)
                sum += a[4 * k] > 0 ? a[4 * k] * v[3 * i + k] * v[3 * j + k] : 0;
            packed[gxsp_packed3(i, j)] = sum;
        }
}

static void gxsp_tangent_make(const gxsp_material *material, const double *f, gxsp_tangent *tangent)
{
    double s[3];
    int k;
    gxsp_svd(f, tangent->u, s, tangent->v);
    gxsp_material_hessian(material, s, tangent->stretch, tangent->even, tangent->odd);
    gxsp_project3(tangent->stretch);
    for (k = 0; k < 3; ++k) { /* the pairs' eigenvalues: flips and twists */
        double sum = tangent->even[k] + tangent->odd[k], difference = tangent->even[k] - tangent->odd[k];
        sum = sum > 0 ? sum : 0;
        difference = difference > 0 ? difference : 0;
        tangent->even[k] = 0.5 * (sum + difference);
        tangent->odd[k] = 0.5 * (sum - difference);
    }
}

/* 3x3 product = a b or, transposed, a^T b */
static void gxsp_multiply(const double *a, int transposed, const double *b, double *product)
{
    int r, c, k;
    for (r = 0; r < 3; ++r)
        for (c = 0; c < 3; ++c) {
            double sum = 0;
            for (k = 0; k < 3; ++k)
                sum += (transposed ? a[3 * k + r] : a[3 * r + k]) * b[3 * k + c];
            product[3 * r + c] = sum;
        }
}

static void gxsp_transpose(double *a)
{
    int r, c;
    for (r = 0; r < 3; ++r)
        for (c = r + 1; c < 3; ++c) {
            double entry = a[3 * r + c];
            a[3 * r + c] = a[3 * c + r];
            a[3 * c + r] = entry;
        }
}

/* h : x in the frame of the stretches. Row r, column c of the pair k = 3 - r - c. */
static void gxsp_tangent_local(const gxsp_tangent *tangent, const double *x, double *y)
{
    const double *a = tangent->stretch;
    int r, c;
    y[0] = a[0] * x[0] + a[1] * x[4] + a[2] * x[8];
    y[4] = a[1] * x[0] + a[3] * x[4] + a[4] * x[8];
    y[8] = a[2] * x[0] + a[4] * x[4] + a[5] * x[8];
    for (r = 0; r < 3; ++r)
        for (c = 0; c < 3; ++c)
            if (r != c)
                y[3 * r + c] = tangent->even[3 - r - c] * x[3 * r + c] + tangent->odd[3 - r - c] * x[3 * c + r];
}

static void gxsp_tangent_product(const gxsp_tangent *tangent, const double *direction, double *product)
{
    double x[9], y[9];
    gxsp_multiply(tangent->u, 1, direction, y); /* x = U^T dF V = (V^T (U^T dF)^T)^T */
    gxsp_transpose(y);
    gxsp_multiply(tangent->v, 1, y, x);
    gxsp_transpose(x);
    gxsp_tangent_local(tangent, x, y);
    gxsp_transpose(y); /* U y V^T = U (V y^T)^T */
    gxsp_multiply(tangent->v, 0, y, x);
    gxsp_transpose(x);
    gxsp_multiply(tangent->u, 0, x, product);
}

/* >>element */

/* Displacement gradient of an element, 3x3 by rows: sum of (u_i - u_0) grad N_i, exactly 0 for translations. */
static void gxsp_displacement_gradient(const gxs_element *element, const double *u, double *g)
{
    const double *u0 = u + 3 * (size_t)element->copy[0];
    double d[3][3]; /* corner, axis */
    int i, r, c;
    for (i = 0; i < 3; ++i) {
        const double *ui = u + 3 * (size_t)element->copy[i + 1];
        for (r = 0; r < 3; ++r)
            d[i][r] = ui[r] - u0[r];
    }
    for (r = 0; r < 3; ++r)
        for (c = 0; c < 3; ++c)
            g[3 * r + c] = d[0][r] * element->gradient[1][c] + d[1][r] * element->gradient[2][c] +
                           d[2][r] * element->gradient[3][c];
}

/* force += weight x stress : grad N; the four add up to zero exactly but for the order of sums */
static void gxsp_scatter_stress(const gxs_element *element, const double *stress, double *force)
{
    double *f0 = force + 3 * (size_t)element->copy[0];
    int i, r;
    for (i = 1; i < 4; ++i) {
        const double *gradient = element->gradient[i];
        double *fi = force + 3 * (size_t)element->copy[i];
        for (r = 0; r < 3; ++r) {
            double f = element->weight * (stress[3 * r] * gradient[0] + stress[3 * r + 1] * gradient[1] +
                                          stress[3 * r + 2] * gradient[2]);
            fi[r] += f;
            f0[r] -= f;
        }
    }
}

/* product += scale x mass block x x */
static void gxsp_scatter_mass(const gxs_element *element, double scale, const double *x, double *product)
{
    static const int packed[4][4] = {{0, 1, 2, 3}, {1, 4, 5, 6}, {2, 5, 7, 8}, {3, 6, 8, 9}};
    int i, j, r;
    for (i = 0; i < 4; ++i) {
        double *to = product + 3 * (size_t)element->copy[i];
        for (j = 0; j < 4; ++j) {
            const double *from = x + 3 * (size_t)element->copy[j];
            double mass = scale * element->mass[packed[i][j]];
            for (r = 0; r < 3; ++r)
                to[r] += mass * from[r];
        }
    }
}

static void gxsp_add_unit(double *g)
{
    g[0] += 1;
    g[4] += 1;
    g[8] += 1;
}

/* Everything a step works with. */
typedef struct gxsp_problem {
    const gxs_model *model;
    const gxs_step_desc *step;
    gxsp_material material;
    size_t n;                 /* copy_count */
    size_t block_count;
    size_t piece_count;       /* free pieces */
    double rate;              /* 1 / dt^2 */
    uint32_t cg_iterations;   /* with the defaults put in */
    double cg_tolerance;
    gxsp_work work;
    gxs_step_report report;
} gxsp_problem;

/* Elastic forces and element energies at the current iterate; their sum is not finite if one of them is not. */
static double gxsp_update_elastic(gxsp_problem *problem)
{
    gxsp_work *work = &problem->work;
    const gxs_element *elements = problem->model->elements;
    double sum = 0;
    size_t e;
    memset(work->elastic, 0, 3 * problem->n * sizeof(double));
    for (e = 0; e < problem->model->element_count; ++e) {
        double g[9], stress[9], noise;
        gxsp_displacement_gradient(&elements[e], work->current, g);
        work->energy[e] = elements[e].weight * gxsp_material_energy(&problem->material, g, &noise);
        sum += work->energy[e];
        gxsp_material_stress(&problem->material, g, stress);
        gxsp_scatter_stress(&elements[e], stress, work->elastic);
    }
    return sum;
}

/* U(trial) - U(current), summed element by element so that what stays the same does not cancel.
 * noise: size of the sum's rounding. */
static double gxsp_elastic_change(const gxsp_problem *problem, double *noise)
{
    const gxsp_work *work = &problem->work;
    const gxs_element *elements = problem->model->elements;
    double sum = 0, size = 0;
    size_t e;
    for (e = 0; e < problem->model->element_count; ++e) {
        double g[9], terms;
        gxsp_displacement_gradient(&elements[e], work->trial, g);
        sum += elements[e].weight * gxsp_material_energy(&problem->material, g, &terms) - work->energy[e];
        size += elements[e].weight * terms;
    }
    *noise = 1e-15 * size;
    return sum;
}

/* Copies and masses of every block; zeros beyond the last element. */
static void gxsp_blocks_begin(gxsp_problem *problem)
{
    const gxs_model *model = problem->model;
    size_t e;
    int k;
    memset(problem->work.blocks, 0, problem->block_count * sizeof(gxsp_block));
    for (e = 0; e < model->element_count; ++e) {
        gxsp_block *block = &problem->work.blocks[e / GXSP_LANES];
        size_t lane = e % GXSP_LANES;
        for (k = 0; k < 4; ++k)
            block->copy[k][lane] = model->elements[e].copy[k];
        for (k = 0; k < 10; ++k)
            block->mass[k][lane] = problem->rate * model->elements[e].mass[k];
    }
}

/* The projected Hessian of one element into its lane. */
static void gxsp_block_linearise(gxsp_block *block, size_t lane, const gxsp_material *material,
                                 const gxs_element *element, const double *u)
{
    gxsp_tangent tangent;
    double f[9], turned[9];
    int k;
    gxsp_displacement_gradient(element, u, f);
    gxsp_add_unit(f);
    gxsp_tangent_make(material, f, &tangent);
    gxsp_multiply(&element->gradient[1][0], 0, tangent.v, turned);
    for (k = 0; k < 9; ++k) {
        block->frame[k][lane] = tangent.u[k];
        block->gradient[k][lane] = turned[k];
    }
    for (k = 0; k < 6; ++k)
        block->stretch[k][lane] = element->weight * tangent.stretch[k];
    for (k = 0; k < 3; ++k) {
        block->even[k][lane] = element->weight * tangent.even[k];
        block->odd[k][lane] = element->weight * tangent.odd[k];
    }
}

/* Arrays of a block's passes never overlap. */
#if !defined(__cplusplus)
#define GXSP_RESTRICT restrict
#elif defined(__GNUC__) || defined(_MSC_VER)
#define GXSP_RESTRICT __restrict
#else
#define GXSP_RESTRICT
#endif

/* Loop over the lanes of a block. Clang is told not to unroll it, since it else does so before it could vectorise. */
#if defined(__clang__)
#define GXSP_EACH_LANE(l) _Pragma("clang loop unroll(disable)") for (l = 0; l < GXSP_LANES; ++l)
#elif defined(__GNUC__)
#define GXSP_EACH_LANE(l) _Pragma("GCC ivdep") for (l = 0; l < GXSP_LANES; ++l)
#else
#define GXSP_EACH_LANE(l) for (l = 0; l < GXSP_LANES; ++l)
#endif

typedef double gxsp_lanes[GXSP_LANES];

/* x of the four copies, one lane per element: gathered[3 corner + axis] */
static void gxsp_block_gather(const gxsp_block *GXSP_RESTRICT block, const double *x, gxsp_lanes *GXSP_RESTRICT gathered)
{
    int i, l;
    for (i = 0; i < 4; ++i)
        for (l = 0; l < GXSP_LANES; ++l) {
            const double *from = x + 3 * (size_t)block->copy[i][l];
            gathered[3 * i][l] = from[0];
            gathered[3 * i + 1][l] = from[1];
            gathered[3 * i + 2][l] = from[2];
        }
}

static void gxsp_block_scatter(const gxsp_block *GXSP_RESTRICT block, gxsp_lanes *GXSP_RESTRICT values, double *y)
{
    int i, l;
    for (l = 0; l < GXSP_LANES; ++l)
        for (i = 0; i < 4; ++i) {
            double *to = y + 3 * (size_t)block->copy[i][l];
            to[0] += values[3 * i][l];
            to[1] += values[3 * i + 1][l];
            to[2] += values[3 * i + 2][l];
        }
}

/* y[12] = mass / dt^2 x[12] */
static void gxsp_block_mass(const gxsp_block *GXSP_RESTRICT block, gxsp_lanes *GXSP_RESTRICT x, gxsp_lanes *GXSP_RESTRICT y)
{
    int r, l;
    for (r = 0; r < 3; ++r)
        GXSP_EACH_LANE(l) {
            double a = x[r][l], b = x[3 + r][l], c = x[6 + r][l], d = x[9 + r][l];
            y[r][l] = block->mass[0][l] * a + block->mass[1][l] * b + block->mass[2][l] * c + block->mass[3][l] * d;
            y[3 + r][l] = block->mass[1][l] * a + block->mass[4][l] * b + block->mass[5][l] * c + block->mass[6][l] * d;
            y[6 + r][l] = block->mass[2][l] * a + block->mass[5][l] * b + block->mass[7][l] * c + block->mass[8][l] * d;
            y[9 + r][l] = block->mass[3][l] * a + block->mass[6][l] * b + block->mass[8][l] * c + block->mass[9][l] * d;
        }
}

/* t[9] = U^T sum (x_i - x_0) (V^T grad N_i)^T: the change of F in the frame of its stretches */
static void gxsp_block_strain(const gxsp_block *GXSP_RESTRICT block, gxsp_lanes *GXSP_RESTRICT x, gxsp_lanes *GXSP_RESTRICT t)
{
    gxsp_lanes d[9];
    int r, c, l;
    for (r = 0; r < 3; ++r)
        for (c = 0; c < 3; ++c)
            GXSP_EACH_LANE(l)
                d[3 * r + c][l] = (x[3 + r][l] - x[r][l]) * block->gradient[c][l] +
                                  (x[6 + r][l] - x[r][l]) * block->gradient[3 + c][l] +
                                  (x[9 + r][l] - x[r][l]) * block->gradient[6 + c][l];
    for (r = 0; r < 3; ++r)
        for (c = 0; c < 3; ++c)
            GXSP_EACH_LANE(l)
                t[3 * r + c][l] = block->frame[r][l] * d[c][l] + block->frame[3 + r][l] * d[3 + c][l] +
                                  block->frame[6 + r][l] * d[6 + c][l];
}

/* y[9] = weight h : t[9] (gxsp_tangent_local on lanes) */
static void gxsp_block_stress(const gxsp_block *GXSP_RESTRICT block, gxsp_lanes *GXSP_RESTRICT t, gxsp_lanes *GXSP_RESTRICT y)
{
    int r, c, l;
    GXSP_EACH_LANE(l) {
        y[0][l] = block->stretch[0][l] * t[0][l] + block->stretch[1][l] * t[4][l] + block->stretch[2][l] * t[8][l];
        y[4][l] = block->stretch[1][l] * t[0][l] + block->stretch[3][l] * t[4][l] + block->stretch[4][l] * t[8][l];
        y[8][l] = block->stretch[2][l] * t[0][l] + block->stretch[4][l] * t[4][l] + block->stretch[5][l] * t[8][l];
    }
    for (r = 0; r < 3; ++r)
        for (c = 0; c < 3; ++c)
            if (r != c)
                GXSP_EACH_LANE(l)
                    y[3 * r + c][l] = block->even[3 - r - c][l] * t[3 * r + c][l] +
                                      block->odd[3 - r - c][l] * t[3 * c + r][l];
}

/* f[12] += U s[9] (V^T grad N_i) */
static void gxsp_block_force(const gxsp_block *GXSP_RESTRICT block, gxsp_lanes *GXSP_RESTRICT s, gxsp_lanes *GXSP_RESTRICT f)
{
    gxsp_lanes p[9];
    int i, r, c, l;
    for (r = 0; r < 3; ++r)
        for (c = 0; c < 3; ++c)
            GXSP_EACH_LANE(l)
                p[3 * r + c][l] = block->frame[3 * r][l] * s[c][l] + block->frame[3 * r + 1][l] * s[3 + c][l] +
                                  block->frame[3 * r + 2][l] * s[6 + c][l];
    for (i = 0; i < 3; ++i)
        for (r = 0; r < 3; ++r)
            GXSP_EACH_LANE(l) {
                double force = p[3 * r][l] * block->gradient[3 * i][l] + p[3 * r + 1][l] * block->gradient[3 * i + 1][l] +
                               p[3 * r + 2][l] * block->gradient[3 * i + 2][l];
                f[3 * i + 3 + r][l] += force;
                f[r][l] -= force;
            }
}

/* y = (K + M / dt^2) x, K the projected Hessian of U at the last linearisation; without elastic: M / dt^2 x.
 * All passes over elements run in this order, block after block, hence the same sums every time. */
static void gxsp_product(const gxsp_problem *problem, int elastic, const double *x, double *y)
{
    size_t b;
    memset(y, 0, 3 * problem->n * sizeof(double));
    for (b = 0; b < problem->block_count; ++b) {
        const gxsp_block *block = &problem->work.blocks[b];
        gxsp_lanes from[12], to[12], strain[9], stress[9];
        gxsp_block_gather(block, x, from);
        gxsp_block_mass(block, from, to);
        if (elastic) {
            gxsp_block_strain(block, from, strain);
            gxsp_block_stress(block, strain, stress);
            gxsp_block_force(block, stress, to);
        }
        gxsp_block_scatter(block, to, y);
    }
}

/* Diagonal 3x3 of corner i in one lane, packed: U B U^T + mass, B_rs = sum h_rc,sd gamma_c gamma_d, gamma = V^T grad N_i. */
static void gxsp_lane_diagonal(const gxsp_block *block, int lane, int corner, double *packed)
{
    static const int own[4] = {0, 4, 7, 9};
    double gamma[3], b[9], ub[9], u[9], square[3];
    int r, s, k;
    for (k = 0; k < 3; ++k) {
        gamma[k] = corner > 0 ? block->gradient[3 * (corner - 1) + k][lane] :
                   -(block->gradient[k][lane] + block->gradient[3 + k][lane] + block->gradient[6 + k][lane]);
        square[k] = gamma[k] * gamma[k];
    }
    for (k = 0; k < 9; ++k)
        u[k] = block->frame[k][lane];
    for (r = 0; r < 3; ++r) {
        int next = (r + 1) % 3, last = (r + 2) % 3;
        b[4 * r] = block->stretch[gxsp_packed3(r, r)][lane] * square[r] + block->even[last][lane] * square[next] +
                   block->even[next][lane] * square[last];
        for (s = r + 1; s < 3; ++s)
            b[3 * r + s] = b[3 * s + r] = gamma[r] * gamma[s] *
                (block->stretch[gxsp_packed3(r, s)][lane] + block->odd[3 - r - s][lane]);
    }
    gxsp_multiply(u, 0, b, ub);
    for (r = 0; r < 3; ++r)
        for (s = r; s < 3; ++s)
            packed[gxsp_packed3(r, s)] = ub[3 * r] * u[3 * s] + ub[3 * r + 1] * u[3 * s + 1] +
                ub[3 * r + 2] * u[3 * s + 2] + (r == s ? block->mass[own[corner]][lane] : 0);
}

/* Inverse of a positive semi-definite 3x3, packed in place, as W^T W with W the inverse Cholesky factor: semi-definite in spite
 * of rounding. 1e-13 of the trace is added, so that a direction without stiffness gives a large number, not an infinite one.
 * Zero stays zero: such a copy is left alone. */
static void gxsp_invert3(double *a)
{
    const double shift = 1e-13;
    double trace = a[0] + a[3] + a[5], scale, l00, l10, l20, l11, l21, l22, w10, w20, w21;
    if (trace <= 0) {
        memset(a, 0, 6 * sizeof *a);
        return;
    }
    scale = 1 / trace;
    l00 = 1 / sqrt(a[0] * scale + shift); /* reciprocals of the factor's diagonal */
    l10 = a[1] * scale * l00;
    l20 = a[2] * scale * l00;
    l11 = a[3] * scale + shift - l10 * l10;
    l11 = 1 / sqrt(l11 > 1e-14 ? l11 : 1e-14);
    l21 = (a[4] * scale - l20 * l10) * l11;
    l22 = a[5] * scale + shift - l20 * l20 - l21 * l21;
    l22 = 1 / sqrt(l22 > 1e-14 ? l22 : 1e-14);
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

/* Hessian and inverse block diagonal at the current iterate. 0 if a number overflowed. */
static int gxsp_linearise(gxsp_problem *problem)
{
    gxsp_work *work = &problem->work;
    const gxs_model *model = problem->model;
    size_t e, i;
    memset(work->diagonal, 0, 6 * problem->n * sizeof(double));
    for (e = 0; e < model->element_count; ++e) {
        gxsp_block *block = &work->blocks[e / GXSP_LANES];
        int lane = (int)(e % GXSP_LANES), corner, k;
        gxsp_block_linearise(block, (size_t)lane, &problem->material, &model->elements[e], work->current);
        for (corner = 0; corner < 4; ++corner) {
            double packed[6], *to = work->diagonal + 6 * (size_t)model->elements[e].copy[corner];
            gxsp_lane_diagonal(block, lane, corner, packed);
            for (k = 0; k < 6; ++k)
                to[k] += packed[k];
        }
    }
    if (gxsp_first_not_finite(work->diagonal, 6 * problem->n) < 6 * problem->n)
        return 0;
    for (i = 0; i < problem->n; ++i) {
        if (work->fixed[i])
            memset(work->diagonal + 6 * i, 0, 6 * sizeof(double));
        gxsp_invert3(work->diagonal + 6 * i);
    }
    return gxsp_first_not_finite(work->diagonal, 6 * problem->n) == 6 * problem->n;
}

/* >>pieces: a translation of a free piece T meets no stiffness: K T = 0, so T^T (K + M / dt^2) x = sum of lumped x. */

static uint32_t gxsp_root(uint32_t *parent, uint32_t i)
{
    while (parent[i] != i) {
        parent[i] = parent[parent[i]];
        i = parent[i];
    }
    return i;
}

/* Does the element give corner i stiffness or mass? */
static int gxsp_supports(const gxs_element *element, size_t i)
{
    static const int own[4] = {0, 4, 7, 9};
    return element->weight > 0 || element->mass[own[i]] > 0;
}

/* Copies that no element supports are fixed like held ones. */
static void gxsp_find_fixed(gxsp_problem *problem)
{
    const gxs_model *model = problem->model;
    uint8_t *fixed = problem->work.fixed;
    size_t e, i;
    memset(fixed, 1, problem->n);
    for (e = 0; e < model->element_count; ++e)
        for (i = 0; i < 4; ++i)
            if (gxsp_supports(&model->elements[e], i))
                fixed[model->elements[e].copy[i]] = 0;
    if (model->held)
        for (i = 0; i < problem->n; ++i)
            if (model->held[i])
                fixed[i] = 1;
}

static void gxsp_join_copies(gxsp_problem *problem)
{
    const gxs_model *model = problem->model;
    uint32_t *parent = problem->work.parent;
    size_t e, i;
    for (i = 0; i < problem->n; ++i)
        parent[i] = (uint32_t)i;
    for (e = 0; e < model->element_count; ++e) {
        const gxs_element *element = &model->elements[e];
        uint32_t root = gxsp_root(parent, element->copy[0]);
        for (i = 1; i < 4; ++i) {
            uint32_t other = gxsp_root(parent, element->copy[i]);
            if (!gxsp_supports(element, 0) && !gxsp_supports(element, i))
                continue;
            if (other < root) {
                parent[root] = other;
                root = other;
            } else
                parent[other] = root;
        }
    }
}

/* Numbers the free pieces: components without a fixed copy and with mass. */
static void gxsp_find_pieces(gxsp_problem *problem)
{
    gxsp_work *work = &problem->work;
    size_t i;
    gxsp_join_copies(problem);
    memset(work->piece_sum, 0, problem->n * sizeof(double)); /* by root: mass; below 0 marks a fixed copy */
    for (i = 0; i < problem->n; ++i)
        work->piece_sum[gxsp_root(work->parent, (uint32_t)i)] += work->lumped[i];
    for (i = 0; i < problem->n; ++i)
        if (work->fixed[i])
            work->piece_sum[gxsp_root(work->parent, (uint32_t)i)] = -1;
    problem->piece_count = 0;
    for (i = 0; i < problem->n; ++i) { /* roots come before their copies: the lower index wins in gxsp_join_copies */
        uint32_t root = gxsp_root(work->parent, (uint32_t)i);
        if (root == i)
            work->piece[i] = work->piece_sum[i] > 0 ? (uint32_t)problem->piece_count++ : GXSP_NO_PIECE;
        else
            work->piece[i] = work->piece[root];
    }
    memset(work->piece_sum, 0, 4 * problem->piece_count * sizeof(double));
    for (i = 0; i < problem->n; ++i)
        if (work->piece[i] != GXSP_NO_PIECE)
            work->piece_sum[4 * (size_t)work->piece[i] + 3] += work->lumped[i];
}

/* Subtracts from x, piece by piece, the translation sum / total mass, where sum is of lumped x (or, if forces are
 * given instead, adds sum of forces / total mass). */
static void gxsp_translate_pieces(const gxsp_problem *problem, const double *forces, double *x)
{
    const gxsp_work *work = &problem->work;
    size_t i, p;
    int r;
    if (problem->piece_count == 0)
        return;
    for (p = 0; p < problem->piece_count; ++p)
        memset(work->piece_sum + 4 * p, 0, 3 * sizeof(double));
    for (i = 0; i < problem->n; ++i)
        if (work->piece[i] != GXSP_NO_PIECE)
            for (r = 0; r < 3; ++r)
                work->piece_sum[4 * (size_t)work->piece[i] + (size_t)r] +=
                    forces ? forces[3 * i + (size_t)r] : -work->lumped[i] * x[3 * i + (size_t)r];
    for (p = 0; p < problem->piece_count; ++p)
        for (r = 0; r < 3; ++r)
            work->piece_sum[4 * p + (size_t)r] /= work->piece_sum[4 * p + 3];
    for (i = 0; i < problem->n; ++i)
        if (work->piece[i] != GXSP_NO_PIECE)
            for (r = 0; r < 3; ++r)
                x[3 * i + (size_t)r] += work->piece_sum[4 * (size_t)work->piece[i] + (size_t)r];
}

/* >>cg */

/* The two measures of a vector r of forces, squared: r . D^-1 r (energy) and |D^-1 r|^2 (displacement). */
typedef struct gxsp_norms {
    double energy, displacement;
} gxsp_norms;

/* scaled = D^-1 r */
static gxsp_norms gxsp_precondition(const gxsp_problem *problem, const double *r, double *scaled)
{
    gxsp_norms norms = {0, 0};
    size_t i;
    for (i = 0; i < problem->n; ++i) {
        const double *d = problem->work.diagonal + 6 * i, *ri = r + 3 * i;
        double x = d[0] * ri[0] + d[1] * ri[1] + d[2] * ri[2];
        double y = d[1] * ri[0] + d[3] * ri[1] + d[4] * ri[2];
        double z = d[2] * ri[0] + d[4] * ri[1] + d[5] * ri[2];
        scaled[3 * i] = x, scaled[3 * i + 1] = y, scaled[3 * i + 2] = z;
        norms.energy += x * ri[0] + y * ri[1] + z * ri[2];
        norms.displacement += x * x + y * y + z * z;
    }
    return norms;
}

/* Solves (K + M / dt^2) direction = residual. The directions of free pieces carry no momentum: their translations are
 * projected out of the preconditioned residual (deflated conjugate gradients; the residual has none, see
 * gxsp_start). 0 if a number overflowed. */
static int gxsp_conjugate_gradients(gxsp_problem *problem)
{
    gxsp_work *work = &problem->work;
    size_t count = 3 * problem->n, i;
    double goal = problem->cg_tolerance * problem->cg_tolerance, rho;
    gxsp_norms first, now;
    uint32_t iteration;
    memset(work->direction, 0, count * sizeof(double));
    first = now = gxsp_precondition(problem, work->residual, work->scaled);
    gxsp_translate_pieces(problem, NULL, work->scaled);
    memcpy(work->search, work->scaled, count * sizeof(double));
    rho = gxsp_dot(work->residual, work->scaled, problem->n);
    for (iteration = 0; iteration < problem->cg_iterations; ++iteration) {
        double curvature, alpha, beta;
        gxsp_product(problem, 1, work->search, work->product);
        curvature = gxsp_dot(work->search, work->product, problem->n);
        if (!gxsp_finite(curvature) || !gxsp_finite(rho))
            return 0;
        if (curvature <= 0 || rho <= 0) /* rounding is all that is left */
            break;
        alpha = rho / curvature;
        for (i = 0; i < count; ++i) {
            work->direction[i] += alpha * work->search[i];
            work->residual[i] -= alpha * work->product[i];
        }
        ++problem->report.cg_iterations;
        now = gxsp_precondition(problem, work->residual, work->scaled);
        if (now.energy <= goal * first.energy && now.displacement <= goal * first.displacement)
            break;
        gxsp_translate_pieces(problem, NULL, work->scaled);
        beta = rho;
        rho = gxsp_dot(work->residual, work->scaled, problem->n);
        beta = rho / beta;
        for (i = 0; i < count; ++i)
            work->search[i] = work->scaled[i] + beta * work->search[i];
    }
    return gxsp_first_not_finite(work->direction, count) == count;
}

/* >>newton */

/* residual = load - inertia - elastic at current, and its size relative to the three (see gxs_step_report) */
static double gxsp_balance(gxsp_problem *problem)
{
    gxsp_work *work = &problem->work;
    gxsp_norms load, inertia, elastic, residual;
    double energy, displacement, by_energy, by_displacement;
    size_t i;
    for (i = 0; i < 3 * problem->n; ++i)
        work->residual[i] = work->load[i] - work->inertia[i] - work->elastic[i];
    load = gxsp_precondition(problem, work->load, work->scaled);
    inertia = gxsp_precondition(problem, work->inertia, work->scaled);
    elastic = gxsp_precondition(problem, work->elastic, work->scaled);
    residual = gxsp_precondition(problem, work->residual, work->scaled);
    energy = sqrt(load.energy) + sqrt(inertia.energy) + sqrt(elastic.energy);
    displacement = sqrt(load.displacement) + sqrt(inertia.displacement) + sqrt(elastic.displacement);
    by_energy = energy > 0 ? sqrt(residual.energy) / energy : 0;
    by_displacement = displacement > 0 ? sqrt(residual.displacement) / displacement : 0;
    return by_energy > by_displacement ? by_energy : by_displacement;
}

/* inertia = M (current - target) / dt^2 */
static void gxsp_update_inertia(gxsp_problem *problem)
{
    gxsp_work *work = &problem->work;
    size_t i;
    for (i = 0; i < 3 * problem->n; ++i)
        work->scaled[i] = work->current[i] - work->target[i];
    gxsp_product(problem, 0, work->scaled, work->inertia);
}

/* Start of Newton at from (target or base), each free piece translated so that its momentum balances. The rest of the
 * iteration cannot change momentum: elastic forces have none, nor do the directions. 0 if the energy is not finite. */
static int gxsp_start(gxsp_problem *problem, const double *from)
{
    gxsp_work *work = &problem->work;
    size_t i, count = 3 * problem->n;
    memcpy(work->current, from, count * sizeof(double));
    gxsp_update_inertia(problem);
    for (i = 0; i < count; ++i)
        work->residual[i] = work->load[i] - work->inertia[i];
    gxsp_translate_pieces(problem, work->residual, work->current);
    gxsp_update_inertia(problem);
    return gxsp_finite(gxsp_update_elastic(problem)) && gxsp_first_not_finite(work->current, count) == count &&
           gxsp_first_not_finite(work->inertia, count) == count && gxsp_first_not_finite(work->elastic, count) == count;
}

/* A step length for the direction, by backtracking on E; current becomes the point found. Inertia and load are
 * quadratic, their change exact; the elastic energy is summed anew. 0: no finite point of lower energy. */
static int gxsp_line_search(gxsp_problem *problem)
{
    gxsp_work *work = &problem->work;
    double linear, slope, curvature, rounding = 0, length = 1; /* rounding: of positions and of the linear terms */
    size_t i, count = 3 * problem->n;
    int trial;
    linear = gxsp_dot(work->inertia, work->direction, problem->n) - gxsp_dot(work->load, work->direction, problem->n);
    slope = linear + gxsp_dot(work->elastic, work->direction, problem->n);
    for (i = 0; i < count; ++i)
        rounding += fabs(work->elastic[i] * work->current[i]) + fabs(work->load[i] * work->direction[i]) +
                    fabs(work->inertia[i] * work->direction[i]);
    gxsp_product(problem, 0, work->direction, work->product);
    curvature = gxsp_dot(work->direction, work->product, problem->n);
    if (!gxsp_finite(slope) || !gxsp_finite(curvature))
        return 0;
    for (trial = 0; trial < GXSP_TRIALS; ++trial) {
        double noise, change, next;
        for (i = 0; i < count; ++i)
            work->trial[i] = work->current[i] + length * work->direction[i];
        ++problem->report.line_search_steps;
        change = gxsp_elastic_change(problem, &noise) + length * (linear + 0.5 * length * curvature);
        if (gxsp_finite(change) && change <= GXSP_ARMIJO * length * slope + noise + 1e-15 * rounding) {
            double *accepted = work->trial;
            work->trial = work->current;
            work->current = accepted;
            return 1;
        }
        /* minimum of the parabola through the two energies and the slope, within 1/10 to 1/2 of the length */
        next = gxsp_finite(change) && change > length * slope ?
               -0.5 * slope * length * length / (change - length * slope) : 0.1 * length;
        length = next < 0.1 * length ? 0.1 * length : next > 0.5 * length ? 0.5 * length : next;
    }
    return 0;
}

/* E at current, J */
static double gxsp_energy(const gxsp_problem *problem)
{
    const gxsp_work *work = &problem->work;
    double sum = 0;
    size_t i;
    for (i = 0; i < problem->model->element_count; ++i)
        sum += work->energy[i];
    for (i = 0; i < 3 * problem->n; ++i)
        sum += 0.5 * (work->current[i] - work->target[i]) * work->inertia[i] - work->load[i] * work->current[i];
    return sum;
}

/* Load, targets, fixed copies, pieces. */
static void gxsp_begin(gxsp_problem *problem, const double *displacement, const double *velocity)
{
    gxsp_work *work = &problem->work;
    const gxs_step_desc *step = problem->step;
    size_t i, r, count = 3 * problem->n;
    gxsp_blocks_begin(problem);
    gxsp_find_fixed(problem);
    for (i = 0; i < count; ++i)
        work->scaled[i] = 1;
    gxsp_product(problem, 0, work->scaled, work->product);
    memcpy(work->base, displacement, count * sizeof(double));
    for (i = 0; i < problem->n; ++i) {
        work->lumped[i] = work->product[3 * i];
        for (r = 0; r < 3; ++r) {
            size_t k = 3 * i + r;
            work->target[k] = displacement[k] + (work->fixed[i] ? 0 : step->dt * velocity[k]);
            work->load[k] = work->lumped[i] * step->dt * step->dt * step->gravity[r] +
                            (step->forces && !work->fixed[i] ? step->forces[k] : 0);
        }
    }
    gxsp_find_pieces(problem);
}

/* Newton's method from a start that gxsp_start found finite to balance or to the end of the budget. */
static gx_result gxsp_newton(gxsp_problem *problem)
{
    const gxs_step_desc *step = problem->step;
    uint32_t budget = step->newton_iterations ? step->newton_iterations : 1, *done = &problem->report.newton_iterations;
    double goal = step->newton_tolerance > GXSP_ROUNDING ? step->newton_tolerance : GXSP_ROUNDING;
    *done = 0;
    if (!gxsp_linearise(problem))
        return GX_ERROR_DIVERGED;
    for (;;) {
        problem->report.residual = gxsp_balance(problem);
        if (!gxsp_finite(problem->report.residual))
            return GX_ERROR_DIVERGED;
        if (problem->report.residual <= goal || *done == budget)
            return GX_OK;
        if (*done > 0 && !gxsp_linearise(problem))
            return GX_ERROR_DIVERGED;
        if (!gxsp_conjugate_gradients(problem))
            return GX_ERROR_DIVERGED;
        if (!gxsp_line_search(problem)) /* after a first success: no more to gain in doubles */
            return *done > 0 ? GX_OK : GX_ERROR_DIVERGED;
        ++*done;
        gxsp_update_inertia(problem);
        gxsp_update_elastic(problem);
    }
}

/* Newton's method from target, which is close to the answer in all but violent motion. If the end is higher in E than base
 * is, or not a number, then from base: so E(u) <= E(base) always, and what a step can add to the energy is bounded. */
static gx_result gxsp_minimise(gxsp_problem *problem)
{
    gx_result result = GX_ERROR_DIVERGED;
    int stay = gxsp_start(problem, problem->work.base);
    double limit = stay ? gxsp_energy(problem) : 0;
    if (gxsp_start(problem, problem->work.target))
        result = gxsp_newton(problem);
    if (stay && gxsp_finite(limit) && (result != GX_OK || gxsp_energy(problem) > limit + 1e-12 * fabs(limit))) {
        gxsp_start(problem, problem->work.base);
        result = gxsp_newton(problem);
    }
    return result;
}

/* Writes the state out, all of it or, if a number is not finite, none. */
static gx_result gxsp_finish(gxsp_problem *problem, double *displacement, double *velocity)
{
    gxsp_work *work = &problem->work;
    size_t i, count = 3 * problem->n;
    double per_second = 1 / problem->step->dt;
    for (i = 0; i < count; ++i)
        work->scaled[i] = work->fixed[i / 3] ? 0 : per_second * (work->current[i] - work->base[i]);
    problem->report.energy = gxsp_energy(problem);
    if (gxsp_first_not_finite(work->scaled, count) < count || gxsp_first_not_finite(work->current, count) < count ||
        !gxsp_finite(problem->report.energy))
        return GX_ERROR_DIVERGED;
    memcpy(displacement, work->current, count * sizeof(double));
    memcpy(velocity, work->scaled, count * sizeof(double));
    return GX_OK;
}

static gx_result gxsp_check_all(const gxs_solver *solver, const gxs_model *model, const gxs_step_desc *step,
                                const double *displacement, const double *velocity, gx_failure *failure)
{
    gx_result result;
    if (!solver)
        return gxsp_fail(failure, GX_ERROR_ARGUMENT, SIZE_MAX);
    if ((result = gxsp_check_step(step, failure)) != GX_OK || (result = gxsp_check_model(model, failure)) != GX_OK ||
        (result = gxsp_check_vector(displacement, model->copy_count, failure)) != GX_OK ||
        (result = gxsp_check_vector(velocity, model->copy_count, failure)) != GX_OK)
        return result;
    return step->forces ? gxsp_check_vector(step->forces, model->copy_count, failure) : GX_OK;
}

static void gxsp_problem_make(gxsp_problem *problem, const gxs_solver *solver, const gxs_model *model,
                              const gxs_step_desc *step)
{
    memset(problem, 0, sizeof *problem);
    problem->model = model;
    problem->step = step;
    problem->material = gxsp_material_make(model->young, model->poisson);
    problem->n = model->copy_count;
    problem->block_count = gxsp_block_count(model->element_count);
    problem->rate = 1 / (step->dt * step->dt);
    problem->cg_iterations = step->cg_iterations ? step->cg_iterations : 1000;
    problem->cg_tolerance = step->cg_tolerance > 0 ? step->cg_tolerance : 1e-2;
    gxsp_work_place(&problem->work, solver->memory, model->copy_count, model->element_count);
}

GXFEM_API gx_result gxs_solver_step(gxs_solver *solver, const gxs_model *model, const gxs_step_desc *step,
                                    double *displacement, double *velocity, gxs_step_report *report,
                                    gx_failure *failure)
{
    gxsp_problem problem;
    gx_failure ignored;
    gx_result result;
    failure = failure ? failure : &ignored;
    gxsp_fail(failure, GX_OK, SIZE_MAX);
    result = gxsp_check_all(solver, model, step, displacement, velocity, failure);
    if (result != GX_OK)
        return result;
    result = gxsp_reserve(solver, model->copy_count, model->element_count);
    if (result != GX_OK)
        return gxsp_fail(failure, result, SIZE_MAX);
    gxsp_problem_make(&problem, solver, model, step);
    gxsp_begin(&problem, displacement, velocity);
    result = gxsp_minimise(&problem);
    if (result == GX_OK)
        result = gxsp_finish(&problem, displacement, velocity);
    if (result != GX_OK)
        return gxsp_fail(failure, result, SIZE_MAX);
    if (report)
        *report = problem.report;
    return GX_OK;
}

GXFEM_API gx_result gxs_solver_create(const gx_allocator *allocator, gxs_solver **solver)
{
    gx_allocator used = {NULL, NULL, NULL};
    gxs_solver *made;
    if (!solver || (allocator && !allocator->allocate != !allocator->release))
        return GX_ERROR_ARGUMENT;
    if (allocator)
        used = *allocator;
    if (!used.allocate) {
        used.allocate = gxsp_malloc;
        used.release = gxsp_free;
    }
    made = (gxs_solver *)used.allocate(used.user, sizeof *made);
    if (!made)
        return GX_ERROR_MEMORY;
    made->allocator = used;
    made->memory = NULL;
    made->size = 0;
    *solver = made;
    return GX_OK;
}

GXFEM_API void gxs_solver_destroy(gxs_solver *solver)
{
    gx_allocator allocator;
    if (!solver)
        return;
    allocator = solver->allocator;
    if (solver->memory)
        allocator.release(allocator.user, solver->memory, solver->size);
    allocator.release(allocator.user, solver, sizeof *solver);
}

/* Model and an input vector of one of the assembled forms. */
static gx_result gxsp_check_form(const gxs_model *model, const double *vector, const void *output)
{
    gx_failure failure;
    gx_result result = gxsp_check_model(model, &failure);
    if (result == GX_OK)
        result = gxsp_check_vector(vector, model->copy_count, &failure);
    return result == GX_OK && !output ? GX_ERROR_ARGUMENT : result;
}

GXFEM_API gx_result gxs_model_energy(const gxs_model *model, const double *displacement, double *energy)
{
    gx_result result = gxsp_check_form(model, displacement, energy);
    gxsp_material material;
    double sum = 0;
    size_t e;
    if (result != GX_OK)
        return result;
    material = gxsp_material_make(model->young, model->poisson);
    for (e = 0; e < model->element_count; ++e) {
        double g[9], noise;
        gxsp_displacement_gradient(&model->elements[e], displacement, g);
        sum += model->elements[e].weight * gxsp_material_energy(&material, g, &noise);
    }
    *energy = sum;
    return GX_OK;
}

GXFEM_API gx_result gxs_model_gradient(const gxs_model *model, const double *displacement, double *gradient)
{
    gx_result result = gxsp_check_form(model, displacement, gradient);
    gxsp_material material;
    size_t e;
    if (result != GX_OK)
        return result;
    material = gxsp_material_make(model->young, model->poisson);
    memset(gradient, 0, 3 * model->copy_count * sizeof(double));
    for (e = 0; e < model->element_count; ++e) {
        double g[9], stress[9];
        gxsp_displacement_gradient(&model->elements[e], displacement, g);
        gxsp_material_stress(&material, g, stress);
        gxsp_scatter_stress(&model->elements[e], stress, gradient);
    }
    return GX_OK;
}

GXFEM_API gx_result gxs_model_hessian_product(const gxs_model *model, const double *displacement,
                                              const double *direction, double *product)
{
    gx_result result = gxsp_check_form(model, displacement, product);
    gx_failure failure;
    gxsp_material material;
    size_t e;
    if (result == GX_OK)
        result = gxsp_check_vector(direction, model->copy_count, &failure);
    if (result != GX_OK)
        return result;
    material = gxsp_material_make(model->young, model->poisson);
    memset(product, 0, 3 * model->copy_count * sizeof(double));
    for (e = 0; e < model->element_count; ++e) {
        double f[9], change[9], stress[9];
        gxsp_tangent tangent;
        gxsp_displacement_gradient(&model->elements[e], displacement, f);
        gxsp_add_unit(f);
        gxsp_tangent_make(&material, f, &tangent);
        gxsp_displacement_gradient(&model->elements[e], direction, change);
        gxsp_tangent_product(&tangent, change, stress);
        gxsp_scatter_stress(&model->elements[e], stress, product);
    }
    return GX_OK;
}

GXFEM_API gx_result gxs_model_mass_product(const gxs_model *model, const double *direction, double *product)
{
    gx_result result = gxsp_check_form(model, direction, product);
    size_t e;
    if (result != GX_OK)
        return result;
    memset(product, 0, 3 * model->copy_count * sizeof(double));
    for (e = 0; e < model->element_count; ++e)
        gxsp_scatter_mass(&model->elements[e], 1, direction, product);
    return GX_OK;
}

static void gxsp_subtract_unit(const double *deformation, double *g)
{
    memcpy(g, deformation, 9 * sizeof *g);
    g[0] -= 1;
    g[4] -= 1;
    g[8] -= 1;
}

GXFEM_API double gxs_stable_neo_hookean_energy(double young, double poisson, const double *deformation)
{
    gxsp_material material = gxsp_material_make(young, poisson);
    double g[9], noise;
    gxsp_subtract_unit(deformation, g);
    return gxsp_material_energy(&material, g, &noise);
}

GXFEM_API void gxs_stable_neo_hookean_stress(double young, double poisson, const double *deformation, double *stress)
{
    gxsp_material material = gxsp_material_make(young, poisson);
    double g[9];
    gxsp_subtract_unit(deformation, g);
    gxsp_material_stress(&material, g, stress);
}

GXFEM_API void gxs_stable_neo_hookean_product(double young, double poisson, const double *deformation,
                                              const double *direction, double *product)
{
    gxsp_material material = gxsp_material_make(young, poisson);
    gxsp_tangent tangent;
    gxsp_tangent_make(&material, deformation, &tangent);
    gxsp_tangent_product(&tangent, direction, product);
}

#ifdef __cplusplus
}
#endif

#undef GXSP_LANES
#undef GXSP_EACH_LANE
#undef GXSP_RESTRICT
#undef GXSP_ROUNDING
#undef GXSP_ARMIJO
#undef GXSP_TRIALS
#undef GXSP_NO_PIECE
#endif /* GXFEM_SOLVE_IMPLEMENTED */
