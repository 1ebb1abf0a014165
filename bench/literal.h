/* literal.h - the cutting of GXFEM's Algorithm 1 as it is published: a mesh Boolean for each nodal subdomain and
   each element subdomain that a cut may touch, by solids of some thickness, results rounded to doubles after each
   cut.

   A baseline of the bench. The Booleans are exact (gxb_boolean); the rest is the paper's. Every node and every
   element keeps its own triangle meshes, each cut on its own. An element subdomain belongs to the nearest nodal
   subdomain (Eq. 16). Element integrals are those of the subdomains' meshes (Eq. 21). The solver is gxfem_solve.h's.

   Algorithm 1 replaces a subdomain where the cut leaves more than one component of it (lines 5 and 15). Otherwise it
   keeps it as it was. So a cut that advances is given as its whole path so far. A cut that ends inside a subdomain
   for good, and only divides it together with a later cut, must be given again together with that one.

   Include after the implementation of gxfem.h. A program that runs out of memory ends here. */
#ifndef GXFEM_BENCH_LITERAL_H
#define GXFEM_BENCH_LITERAL_H

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include "clock.h"

/* ---- types ---- */

/* A nodal or an element subdomain by its boundary */
typedef struct literal_domain {
    /* x 3 */
    double *vertices;
    size_t vertex_count;
    /* x 3, counter-clockwise from outside */
    uint32_t *triangles;
    size_t triangle_count;
    uint32_t next; /* of the same node or element; LITERAL_NONE: none */
    uint32_t copy; /* nodal: the displacement it has; element: not read */
} literal_domain;

#define LITERAL_NONE UINT32_MAX

typedef struct literal_domains {
    literal_domain *domains;
    size_t count, capacity;
    uint32_t *first; /* by node or element */
} literal_domains;

/* A box of a binary tree over the elements */
/* count 0: children first, first + 1 */
typedef struct literal_box {
    double low[3], high[3];
    uint32_t first, count;
} literal_box;

typedef struct literal_desc {
    /* x 3 */
    const double *positions;
    size_t node_count;
    /* x 4, of positive volume */
    const uint32_t *elements;
    size_t element_count;
    double density; /* kg/m3 */
    /* 1: not as published: results in few triangles, defects of rounding mended (gxb_boolean_set_mend) */
    int mended;
} literal_desc;

/* Of all cuts so far */
typedef struct literal_report {
    /* failures: Booleans that the rounding of earlier ones made impossible */
    size_t booleans, failures;
    double seconds_booleans, seconds_integrals, seconds; /* seconds: all of it, matching included */
} literal_report;

typedef struct literal {
    literal_desc desc; /* arrays of its own */
    literal_domains nodal, element;
    literal_box *boxes;
    uint32_t box_count;
    uint32_t *box_elements;
    /* copies; x 3; x 3 */
    uint32_t *copy_node;
    double *displacement, *velocity;
    size_t copy_count, copy_capacity;
    uint8_t *dirty; /* elements whose integrals and copies are to be found again */
    /* by element subdomain; all are up to date after literal_model */
    gxs_element *parts;
    size_t part_count;
    double *rest; /* copies x 3 */
    literal_report report;
} literal;

/* ---- memory ---- */

static void *literal_memory(void *old, size_t count, size_t size) {
    void *memory = realloc(old, count * size + 1);
    if (memory) return memory;
    fputs("literal: no memory\n", stderr);
    exit(1);
}

static void literal_drop_domain(literal_domain *domain) {
    free(domain->vertices);
    free(domain->triangles);
}

static literal_domain *literal_add_domain(literal_domains *all, uint32_t owner) {
    literal_domain *domain;
    if (all->count == all->capacity) {
        all->capacity = 2 * all->capacity + 16;
        all->domains = (literal_domain *)literal_memory(all->domains, all->capacity, sizeof *all->domains);
    }
    domain = &all->domains[all->count];
    memset(domain, 0, sizeof *domain);
    domain->next = all->first[owner];
    all->first[owner] = (uint32_t)all->count++;
    return domain;
}

static uint32_t literal_add_copy(literal *l, uint32_t node, uint32_t from) {
    const size_t i = l->copy_count++;
    if (i == l->copy_capacity) {
        l->copy_capacity = 2 * i + 16;
        l->copy_node = (uint32_t *)literal_memory(l->copy_node, l->copy_capacity, sizeof(uint32_t));
        l->displacement = (double *)literal_memory(l->displacement, 3 * l->copy_capacity, sizeof(double));
        l->velocity = (double *)literal_memory(l->velocity, 3 * l->copy_capacity, sizeof(double));
    }
    l->copy_node[i] = node;
    memset(l->displacement + 3 * i, 0, 3 * sizeof(double));
    memset(l->velocity + 3 * i, 0, 3 * sizeof(double));
    if (from != LITERAL_NONE) {
        memcpy(l->displacement + 3 * i, l->displacement + 3 * (size_t)from, 3 * sizeof(double));
        memcpy(l->velocity + 3 * i, l->velocity + 3 * (size_t)from, 3 * sizeof(double));
    }
    return (uint32_t)i;
}

/* ---- the first culling: boxes over the elements ---- */

static void literal_fit_box(const literal *l, literal_box *box) {
    uint32_t i;
    int n, k;
    for (k = 0; k < 3; k++) {
        box->low[k] = HUGE_VAL;
        box->high[k] = -HUGE_VAL;
    }
    for (i = box->first; i < box->first + box->count; i++)
        for (n = 0; n < 4; n++)
            for (k = 0; k < 3; k++) {
                const double x =
                    l->desc.positions[3 * (size_t)l->desc.elements[4 * (size_t)l->box_elements[i] + (size_t)n] +
                                      (size_t)k];
                box->low[k] = fmin(box->low[k], x);
                box->high[k] = fmax(box->high[k], x);
            }
}

typedef struct literal_key {
    double at;
    uint32_t element;
} literal_key;

static int literal_key_order(const void *a, const void *b) {
    const literal_key *x = (const literal_key *)a, *y = (const literal_key *)b;
    return x->at != y->at ? (x->at > y->at) - (x->at < y->at) : (x->element > y->element) - (x->element < y->element);
}

static void literal_sort_box(literal *l, const literal_box *box, int axis, literal_key *keys) {
    uint32_t i;
    int n;
    for (i = 0; i < box->count; i++) {
        keys[i].element = l->box_elements[box->first + i];
        keys[i].at = 0;
        for (n = 0; n < 4; n++)
            keys[i].at +=
                l->desc.positions[3 * (size_t)l->desc.elements[4 * (size_t)keys[i].element + (size_t)n] + (size_t)axis];
    }
    qsort(keys, box->count, sizeof *keys, literal_key_order);
    for (i = 0; i < box->count; i++) l->box_elements[box->first + i] = keys[i].element;
}

static void literal_build_boxes(literal *l) {
    const uint32_t n = (uint32_t)l->desc.element_count;
    literal_key *keys = (literal_key *)literal_memory(NULL, n, sizeof *keys);
    uint32_t b;
    l->boxes = (literal_box *)literal_memory(NULL, 2 * (size_t)n, sizeof *l->boxes);
    l->box_elements = (uint32_t *)literal_memory(NULL, n, sizeof(uint32_t));
    for (b = 0; b < n; b++) l->box_elements[b] = b;
    l->boxes[0].first = 0;
    l->boxes[0].count = n;
    l->box_count = 1;
    for (b = 0; b < l->box_count; b++) {
        literal_box *box = &l->boxes[b], *child = &l->boxes[l->box_count];
        int axis = 0, k;
        literal_fit_box(l, box);
        if (box->count <= 4) continue;
        for (k = 1; k < 3; k++)
            if (box->high[k] - box->low[k] > box->high[axis] - box->low[axis]) axis = k;
        literal_sort_box(l, box, axis, keys);
        child[0].first = box->first;
        child[0].count = box->count / 2;
        child[1].first = box->first + child[0].count;
        child[1].count = box->count - child[0].count;
        box->first = l->box_count;
        box->count = 0;
        l->box_count += 2;
    }
    free(keys);
}

/* Marks the elements whose boxes meet the triangle's box. */
static void literal_mark_elements(const literal *l, const double *const p[3], uint8_t *touched) {
    double low[3], high[3];
    uint32_t stack[64], depth = 0, i;
    int k;
    for (k = 0; k < 3; k++) {
        low[k] = fmin(p[0][k], fmin(p[1][k], p[2][k]));
        high[k] = fmax(p[0][k], fmax(p[1][k], p[2][k]));
    }
    stack[depth++] = 0;
    while (depth > 0) {
        const literal_box *box = &l->boxes[stack[--depth]];
        for (k = 0; k < 3 && low[k] <= box->high[k] && high[k] >= box->low[k]; k++) continue;
        if (k < 3) continue;
        for (i = 0; i < box->count; i++) touched[l->box_elements[box->first + i]] = 1;
        if (box->count > 0) continue;
        stack[depth++] = box->first;
        stack[depth++] = box->first + 1;
    }
}

/* ---- creation ---- */

static const uint32_t literal_faces[4][3] = {{1, 2, 3}, {0, 3, 2}, {0, 1, 3}, {0, 2, 1}}; /* outward */

/* A triangle of a 1-ring, and its nodes in ascending order */
typedef struct literal_face {
    uint32_t nodes[3], sorted[3];
} literal_face;

static int literal_face_order(const void *a, const void *b) {
    return memcmp(((const literal_face *)a)->sorted, ((const literal_face *)b)->sorted, 3 * sizeof(uint32_t));
}

static void literal_sort3(uint32_t *v) {
    int i, j;
    for (i = 0; i < 2; i++)
        for (j = 0; j < 2 - i; j++)
            if (v[j] > v[j + 1]) {
                const uint32_t t = v[j];
                v[j] = v[j + 1];
                v[j + 1] = t;
            }
}

/* Faces that only one of the elements has; returns their number. */
static size_t literal_boundary(const literal_desc *desc, const uint32_t *ring, size_t count, literal_face *faces) {
    size_t i, n = 0, kept = 0;
    int f, k;
    for (i = 0; i < count; i++)
        for (f = 0; f < 4; f++, n++) {
            for (k = 0; k < 3; k++) faces[n].nodes[k] = desc->elements[4 * (size_t)ring[i] + literal_faces[f][k]];
            memcpy(faces[n].sorted, faces[n].nodes, sizeof faces[n].nodes);
            literal_sort3(faces[n].sorted);
        }
    qsort(faces, n, sizeof *faces, literal_face_order);
    for (i = 0; i < n; i++) {
        if (i + 1 < n && literal_face_order(&faces[i], &faces[i + 1]) == 0)
            i++;
        else
            faces[kept++] = faces[i];
    }
    return kept;
}

/* The boundary of some elements as a mesh of its own; number: scratch, node_count, LITERAL_NONE before and after. */
static void literal_fill_domain(const literal_desc *desc, literal_domain *domain, const literal_face *faces,
                                size_t count, uint32_t *number) {
    size_t i, n = 0;
    int k;
    domain->vertices = (double *)literal_memory(NULL, 9 * count, sizeof(double));
    domain->triangles = (uint32_t *)literal_memory(NULL, 3 * count, sizeof(uint32_t));
    domain->triangle_count = count;
    for (i = 0; i < count; i++)
        for (k = 0; k < 3; k++) {
            const uint32_t node = faces[i].nodes[k];
            if (number[node] == LITERAL_NONE) {
                memcpy(domain->vertices + 3 * n, desc->positions + 3 * (size_t)node, 3 * sizeof(double));
                number[node] = (uint32_t)n++;
            }
            domain->triangles[3 * i + (size_t)k] = number[node];
        }
    domain->vertex_count = n;
    for (i = 0; i < count; i++)
        for (k = 0; k < 3; k++) number[faces[i].nodes[k]] = LITERAL_NONE;
}

/* Elements around each node: start (node_count + 1) into ring */
static void literal_rings(const literal_desc *desc, uint32_t *start, uint32_t *ring) {
    size_t i;
    memset(start, 0, (desc->node_count + 1) * sizeof *start);
    for (i = 0; i < 4 * desc->element_count; i++) start[desc->elements[i] + 1]++;
    for (i = 0; i < desc->node_count; i++) start[i + 1] += start[i];
    for (i = 0; i < 4 * desc->element_count; i++) ring[start[desc->elements[i]]++] = (uint32_t)(i / 4);
    for (i = desc->node_count; i > 0; i--) start[i] = start[i - 1];
    start[0] = 0;
}

static void literal_make_domains(literal *l) {
    const literal_desc *desc = &l->desc;
    uint32_t *start = (uint32_t *)literal_memory(NULL, desc->node_count + 1, sizeof *start);
    uint32_t *ring = (uint32_t *)literal_memory(NULL, 4 * desc->element_count, sizeof *ring);
    uint32_t *number = (uint32_t *)literal_memory(NULL, desc->node_count, sizeof *number), i;
    literal_rings(desc, start, ring);
    memset(number, 0xff, desc->node_count * sizeof *number);
    for (i = 0; i < desc->node_count; i++) {
        const size_t count = start[i + 1] - start[i];
        literal_face *faces = (literal_face *)literal_memory(NULL, 4 * count, sizeof *faces);
        literal_domain *domain = literal_add_domain(&l->nodal, i);
        literal_fill_domain(desc, domain, faces, literal_boundary(desc, ring + start[i], count, faces), number);
        domain->copy = literal_add_copy(l, i, LITERAL_NONE);
        free(faces);
    }
    for (i = 0; i < desc->element_count; i++) {
        literal_face faces[4];
        literal_fill_domain(desc, literal_add_domain(&l->element, i), faces, literal_boundary(desc, &i, 1, faces),
                            number);
    }
    free(start);
    free(ring);
    free(number);
}

static void literal_start(literal_domains *all, size_t owners) {
    all->first = (uint32_t *)literal_memory(NULL, owners, sizeof *all->first);
    memset(all->first, 0xff, owners * sizeof *all->first);
}

static literal *literal_create(const literal_desc *desc) {
    literal *l = (literal *)literal_memory(NULL, 1, sizeof *l);
    double *positions = (double *)literal_memory(NULL, 3 * desc->node_count, sizeof(double));
    uint32_t *elements = (uint32_t *)literal_memory(NULL, 4 * desc->element_count, sizeof(uint32_t));
    memset(l, 0, sizeof *l);
    memcpy(positions, desc->positions, 3 * desc->node_count * sizeof(double));
    memcpy(elements, desc->elements, 4 * desc->element_count * sizeof(uint32_t));
    l->desc = *desc;
    l->desc.positions = positions;
    l->desc.elements = elements;
    literal_start(&l->nodal, desc->node_count);
    literal_start(&l->element, desc->element_count);
    l->dirty = (uint8_t *)literal_memory(NULL, desc->element_count, 1);
    memset(l->dirty, 1, desc->element_count);
    literal_make_domains(l);
    literal_build_boxes(l);
    return l;
}

static void literal_free_domains(literal_domains *all) {
    size_t i;
    for (i = 0; i < all->count; i++) literal_drop_domain(&all->domains[i]);
    free(all->domains);
    free(all->first);
}

static void literal_destroy(literal *l) {
    literal_free_domains(&l->nodal);
    literal_free_domains(&l->element);
    free((void *)(uintptr_t)l->desc.positions);
    free((void *)(uintptr_t)l->desc.elements);
    free(l->boxes);
    free(l->box_elements);
    free(l->copy_node);
    free(l->displacement);
    free(l->velocity);
    free(l->dirty);
    free(l->parts);
    free(l->rest);
    free(l);
}

/* ---- cutting ---- */

/* An edge of a triangle, its vertices in ascending order */
typedef struct literal_edge {
    uint32_t v[2], triangle;
} literal_edge;

static int literal_edge_order(const void *a, const void *b) {
    const literal_edge *x = (const literal_edge *)a, *y = (const literal_edge *)b;
    const int order = memcmp(x->v, y->v, sizeof x->v);
    return order ? order : (x->triangle > y->triangle) - (x->triangle < y->triangle);
}

static uint32_t literal_root(uint32_t *parent, uint32_t i) {
    while (parent[i] != i) i = parent[i] = parent[parent[i]];
    return i;
}

/* Numbers the connected components of adjacent triangles (as the paper finds them); returns their number. */
static uint32_t literal_components(const gxb_boolean_result *result, uint32_t *component) {
    const uint32_t n = (uint32_t)result->triangle_count;
    literal_edge *edges = (literal_edge *)literal_memory(NULL, 3 * (size_t)n, sizeof *edges);
    uint32_t *parent = (uint32_t *)literal_memory(NULL, n, sizeof *parent), i, count = 0;
    for (i = 0; i < 3 * n; i++) {
        const uint32_t a = result->triangles[i], b = result->triangles[i % 3 == 2 ? i - 2 : i + 1];
        edges[i].v[0] = a < b ? a : b;
        edges[i].v[1] = a < b ? b : a;
        edges[i].triangle = i / 3;
        parent[i / 3] = i / 3;
    }
    qsort(edges, 3 * (size_t)n, sizeof *edges, literal_edge_order);
    for (i = 1; i < 3 * n; i++) {
        if (memcmp(edges[i].v, edges[i - 1].v, sizeof edges[i].v) != 0) continue;
        parent[literal_root(parent, edges[i].triangle)] = literal_root(parent, edges[i - 1].triangle);
    }
    for (i = 0; i < n; i++)
        if (literal_root(parent, i) == i) component[i] = count++;
    for (i = 0; i < n; i++) component[i] = component[literal_root(parent, i)];
    free(edges);
    free(parent);
    return count;
}

/* One component of a Boolean's result as a domain */
static void literal_take_component(literal_domain *domain, const gxb_boolean_result *result, const uint32_t *components,
                                   uint32_t component, uint32_t *number) {
    size_t t, n = 0, count = 0;
    int k;
    memset(number, 0xff, result->vertex_count * sizeof *number);
    domain->vertices = (double *)literal_memory(NULL, 3 * result->vertex_count, sizeof(double));
    domain->triangles = (uint32_t *)literal_memory(NULL, 3 * result->triangle_count, sizeof(uint32_t));
    for (t = 0; t < result->triangle_count; t++) {
        if (components[t] != component) continue;
        for (k = 0; k < 3; k++) {
            const uint32_t v = result->triangles[3 * t + (size_t)k];
            if (number[v] == LITERAL_NONE) {
                memcpy(domain->vertices + 3 * n, result->vertices + 3 * (size_t)v, 3 * sizeof(double));
                number[v] = (uint32_t)n++;
            }
            domain->triangles[3 * count + (size_t)k] = number[v];
        }
        count++;
    }
    domain->vertex_count = n;
    domain->triangle_count = count;
}

static int literal_boxes_meet(const literal_domain *domain, const gx_surface *solid) {
    double low[2][3], high[2][3];
    const double *x[2] = {domain->vertices, solid->vertices};
    const size_t count[2] = {domain->vertex_count, solid->vertex_count};
    size_t i;
    int a, k;
    for (a = 0; a < 2; a++)
        for (k = 0; k < 3; k++) {
            low[a][k] = HUGE_VAL;
            high[a][k] = -HUGE_VAL;
            for (i = 0; i < count[a]; i++) {
                low[a][k] = fmin(low[a][k], x[a][3 * i + (size_t)k]);
                high[a][k] = fmax(high[a][k], x[a][3 * i + (size_t)k]);
            }
        }
    for (k = 0; k < 3; k++)
        if (low[0][k] > high[1][k] || low[1][k] > high[0][k]) return 0;
    return 1;
}

static gx_result literal_add_operand(gxb_boolean *boolean, const double *vertices, size_t vertex_count,
                                     const uint32_t *triangles, size_t triangle_count, uint32_t operation) {
    gxb_operand operand;
    memset(&operand, 0, sizeof operand);
    operand.vertices = vertices;
    operand.vertex_count = vertex_count;
    operand.triangles = triangles;
    operand.triangle_count = triangle_count;
    operand.operation = operation;
    operand.rule = GXB_POSITIVE; /* rounded surfaces may be turned inside out in places: no material there */
    return gxb_boolean_add(boolean, &operand, NULL);
}

/* Domain less solids. 0: no solid is near, or the Boolean failed; there is no result then */
static int literal_subtract(literal *l, const literal_domain *domain, const gx_surface *solids, size_t count,
                            gxb_boolean **boolean, gxb_boolean_result *result) {
    gx_result code;
    size_t i, near = 0;
    code = gxb_boolean_create(NULL, boolean, NULL);
    if (code == GX_OK && l->desc.mended) {
        gxb_boolean_set_mend(*boolean, 1, NULL);
        gxb_boolean_set_triangulation(*boolean, GXB_COARSE, NULL);
    }
    if (code == GX_OK)
        code = literal_add_operand(*boolean, domain->vertices, domain->vertex_count, domain->triangles,
                                   domain->triangle_count, GXB_UNION);
    for (i = 0; i < count && code == GX_OK; i++) {
        const gx_surface *s = &solids[i];
        if (!literal_boxes_meet(domain, s)) continue;
        code = literal_add_operand(*boolean, s->vertices, s->vertex_count, s->triangles, s->triangle_count,
                                   GXB_DIFFERENCE);
        near++;
    }
    if (code == GX_OK && near > 0) {
        l->report.booleans++;
        code = gxb_boolean_evaluate(*boolean, result, NULL);
    }
    l->report.failures += code != GX_OK;
    if (code == GX_OK && near > 0) return 1;
    gxb_boolean_destroy(*boolean);
    return 0;
}

/* Puts the components in the domain's place: the first takes its slot, the others get new ones. Nodal ones other
   than the first get copies. */
static void literal_replace(literal *l, literal_domains *all, uint32_t owner, uint32_t at,
                            const gxb_boolean_result *result, const uint32_t *components, uint32_t count) {
    uint32_t *number = (uint32_t *)literal_memory(NULL, result->vertex_count, sizeof *number), c;
    for (c = 0; c < count; c++) {
        const uint32_t copy = all->domains[at].copy;
        literal_domain *domain = c == 0 ? &all->domains[at] : literal_add_domain(all, owner);
        if (c == 0) literal_drop_domain(domain);
        literal_take_component(domain, result, components, c, number);
        if (c > 0 && all == &l->nodal) domain->copy = literal_add_copy(l, owner, copy);
    }
    free(number);
}

/* Lines 2 to 9, or 12 to 18, for the subdomains of one node or element. Returns 1 if one was replaced. */
static int literal_cut_domains(literal *l, literal_domains *all, uint32_t owner, const gx_surface *solids,
                               size_t count) {
    uint32_t at, next;
    int changed = 0;
    for (at = all->first[owner]; at != LITERAL_NONE; at = next) {
        gxb_boolean *boolean = NULL;
        gxb_boolean_result result;
        uint32_t *components, found;
        next = all->domains[at].next;
        if (!literal_subtract(l, &all->domains[at], solids, count, &boolean, &result)) continue;
        components = (uint32_t *)literal_memory(NULL, result.triangle_count, sizeof *components);
        found = literal_components(&result, components);
        if (found > 1) {
            literal_replace(l, all, owner, at, &result, components, found);
            changed = 1;
        }
        free(components);
        gxb_boolean_destroy(boolean);
    }
    return changed;
}

/* Which elements the surface's triangles may touch, and their nodes */
static void literal_cull(const literal *l, const gx_surface *surface, uint8_t *touched, uint8_t *nodes) {
    size_t i;
    for (i = 0; i < surface->triangle_count; i++) {
        const uint32_t *t = surface->triangles + 3 * i;
        const double *const p[3] = {surface->vertices + 3 * (size_t)t[0], surface->vertices + 3 * (size_t)t[1],
                                    surface->vertices + 3 * (size_t)t[2]};
        literal_mark_elements(l, p, touched);
    }
    for (i = 0; i < 4 * l->desc.element_count; i++) nodes[l->desc.elements[i]] |= touched[i / 4];
}

/* Cuts by closed surfaces, all at once: lines 1 to 19. Only subdomains that the triangles of `fresh` may touch are
   visited (NULL: of all solids). Integrals and copies of elements: see literal_model. */
static void literal_cut(literal *l, const gx_surface *solids, size_t count, const gx_surface *fresh) {
    uint8_t *touched = (uint8_t *)literal_memory(NULL, l->desc.element_count, 1),
            *nodes = (uint8_t *)literal_memory(NULL, l->desc.node_count, 1);
    const double start = seconds(NULL);
    size_t i;
    memset(touched, 0, l->desc.element_count);
    memset(nodes, 0, l->desc.node_count);
    for (i = 0; i < (fresh ? 1 : count); i++) literal_cull(l, fresh ? fresh : &solids[i], touched, nodes);
    for (i = 0; i < l->desc.node_count; i++)
        nodes[i] = (uint8_t)(nodes[i] && literal_cut_domains(l, &l->nodal, (uint32_t)i, solids, count));
    for (i = 0; i < l->desc.element_count; i++)
        l->dirty[i] |= (uint8_t)(touched[i] && literal_cut_domains(l, &l->element, (uint32_t)i, solids, count));
    for (i = 0; i < 4 * l->desc.element_count; i++) l->dirty[i / 4] |= nodes[l->desc.elements[i]];
    l->report.seconds_booleans += seconds(NULL) - start;
    l->report.seconds += seconds(NULL) - start;
    free(touched);
    free(nodes);
}

/* ---- the nodal subdomain to which an element subdomain belongs (Eq. 15 and 16) ---- */

static double literal_dot(const double *a, const double *b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

/* Squared distance of x to the segment a b */
static double literal_segment_distance(const double *x, const double *a, const double *b) {
    double ab[3], ax[3], length, t, sum = 0;
    int k;
    for (k = 0; k < 3; k++) {
        ab[k] = b[k] - a[k];
        ax[k] = x[k] - a[k];
    }
    length = literal_dot(ab, ab);
    t = length > 0 ? fmin(1, fmax(0, literal_dot(ax, ab) / length)) : 0;
    for (k = 0; k < 3; k++) sum += (ax[k] - t * ab[k]) * (ax[k] - t * ab[k]);
    return sum;
}

/* Squared distance of x to the triangle: to its plane where x lies above it, else to its edges */
static double literal_triangle_distance(const double *x, const double *const p[3]) {
    double u[3], v[3], w[3], uu, uv, vv, uw, vw, det, s, t, sum = 0;
    int k;
    for (k = 0; k < 3; k++) {
        u[k] = p[1][k] - p[0][k];
        v[k] = p[2][k] - p[0][k];
        w[k] = x[k] - p[0][k];
    }
    uu = literal_dot(u, u);
    uv = literal_dot(u, v);
    vv = literal_dot(v, v);
    uw = literal_dot(u, w);
    vw = literal_dot(v, w);
    det = uu * vv - uv * uv;
    s = uw * vv - vw * uv;
    t = vw * uu - uw * uv;
    if (det > 0 && s >= 0 && t >= 0 && s + t <= det) {
        for (k = 0; k < 3; k++) sum += (w[k] - (s * u[k] + t * v[k]) / det) * (w[k] - (s * u[k] + t * v[k]) / det);
        return sum;
    }
    return fmin(literal_segment_distance(x, p[0], p[1]),
                fmin(literal_segment_distance(x, p[1], p[2]), literal_segment_distance(x, p[2], p[0])));
}

/* Distance of a point to a subdomain; 0 inside */
static double literal_distance(const literal_domain *domain, const double x[3]) {
    double least = HUGE_VAL;
    size_t t;
    int on = 0, k;
    if (gxb_winding_number(domain->vertices, domain->triangles, domain->triangle_count, x, &on) != 0 || on) return 0;
    for (t = 0; t < domain->triangle_count; t++) {
        const double *p[3];
        for (k = 0; k < 3; k++) p[k] = domain->vertices + 3 * (size_t)domain->triangles[3 * t + (size_t)k];
        least = fmin(least, literal_triangle_distance(x, p));
    }
    return least;
}

/* A point of the subdomain: the middle of its largest triangle */
static void literal_point(const literal_domain *domain, double x[3]) {
    double largest = -1;
    size_t t;
    int k;
    for (t = 0; t < domain->triangle_count; t++) {
        const double *p[3];
        double vector[3], area;
        for (k = 0; k < 3; k++) p[k] = domain->vertices + 3 * (size_t)domain->triangles[3 * t + (size_t)k];
        area = gxi_triangle_area(p[0], p[1], p[2], vector);
        if (area <= largest) continue;
        largest = area;
        for (k = 0; k < 3; k++) x[k] = (p[0][k] + p[1][k] + p[2][k]) / 3;
    }
}

static uint32_t literal_copy_of(const literal *l, uint32_t node, const double x[3]) {
    uint32_t at = l->nodal.first[node], copy = l->nodal.domains[at].copy;
    double least = HUGE_VAL;
    if (l->nodal.domains[at].next == LITERAL_NONE) return copy;
    for (; at != LITERAL_NONE && least > 0; at = l->nodal.domains[at].next) {
        const double distance = literal_distance(&l->nodal.domains[at], x);
        if (distance >= least) continue;
        least = distance;
        copy = l->nodal.domains[at].copy;
    }
    return copy;
}

/* ---- integrals (Eq. 21) and the solver's model ---- */

static void literal_part(const literal *l, uint32_t element, const literal_domain *domain, gxs_element *part) {
    double corners[12], gradients[12], volume, matrix[9], translation[3], x[3];
    const gxi_surface surface = {domain->vertices, domain->vertex_count, domain->triangles, domain->triangle_count};
    gxi_moments2 m;
    int n, k;
    memset(part, 0, sizeof *part);
    literal_point(domain, x);
    for (n = 0; n < 4; n++) {
        const uint32_t node = l->desc.elements[4 * (size_t)element + (size_t)n];
        memcpy(corners + 3 * n, l->desc.positions + 3 * (size_t)node, 3 * sizeof(double));
        part->copy[n] = literal_copy_of(l, node, x);
    }
    if (gxi_tet_gradients(corners, gradients, &volume) != GX_OK ||
        gxi_polyhedron_moments2(&surface, corners, &m, NULL) != GX_OK)
        return;
    memcpy(part->gradient, gradients, sizeof part->gradient);
    memcpy(matrix, gradients + 3, sizeof matrix);
    for (k = 0; k < 3; k++) translation[k] = 0;
    part->weight = fmax(0, m.volume);
    gxi_moments2_map(&m, matrix, translation);
    gxi_part_mass(&m, 0, volume, l->desc.density, part->mass);
    /* of a sliver, by rounding */
    if (part->mass[0] < 0 || part->mass[4] < 0 || part->mass[7] < 0 || part->mass[9] < 0)
        memset(part->mass, 0, sizeof part->mass);
}

/* Lines 20 to 24: the solver's model, without the materials. Arrays are valid until the next cut. */
static void literal_model(literal *l, gxs_model *model) {
    const double start = seconds(NULL);
    size_t i;
    uint32_t e, at;
    l->parts = (gxs_element *)literal_memory(l->parts, l->element.count, sizeof *l->parts);
    l->rest = (double *)literal_memory(l->rest, 3 * l->copy_count, sizeof(double));
    l->part_count = l->element.count;
    for (e = 0; e < l->desc.element_count; e++) {
        if (!l->dirty[e]) continue;
        for (at = l->element.first[e]; at != LITERAL_NONE; at = l->element.domains[at].next)
            literal_part(l, e, &l->element.domains[at], &l->parts[at]);
        l->dirty[e] = 0;
    }
    for (i = 0; i < l->copy_count; i++)
        memcpy(l->rest + 3 * i, l->desc.positions + 3 * (size_t)l->copy_node[i], 3 * sizeof(double));
    memset(model, 0, sizeof *model);
    model->copy_count = l->copy_count;
    model->positions = l->rest;
    model->elements = l->parts;
    model->element_count = l->part_count;
    l->report.seconds_integrals += seconds(NULL) - start;
    l->report.seconds += seconds(NULL) - start;
}

#endif
