/* parts.h - the parts into which cuts have divided a body's elements: integrals over them by points, in place of the
   library's, and which part contains a point.

   Parts are the elements of gx_body_model: cells with the same four copies are one part. The planes of the body's
   own arrangement decide, in doubles, which part contains a point. That is kinder to sampling than a search of its
   own would be: sampling is charged with points, not with geometry.
       parts_regular    n^3 cells of each divided element's reference tetrahedron (sampling.h)
       parts_adaptive   subdivision to a depth, rules of degree 2 in its tetrahedra
       parts_positive   positive weights at inner points from exact moments, degree 2
       parts_rxfem      the moments that RXFEM's rule fits (rxfem.h), where it makes the same parts
       parts_delete     element deletion: the whole elements, on uncut nodes, whose inside no cut meets

   Include after rxfem_model.h, part.h and sampling.h. Out of memory ends the program. */
#ifndef GXFEM_BENCH_PARTS_H
#define GXFEM_BENCH_PARTS_H

#define PARTS_NONE UINT32_MAX

typedef struct parts_body {
    gx_body *body;       /* borrowed; it must neither be cut nor held again while this is in use */
    gxs_model model;     /* of the body */
    uint32_t *first;     /* element_count + 1: parts of each element in model.elements */
    uint32_t *leaf_part; /* by leaf of the body's complex; PARTS_NONE: removed */
    uint32_t *leaves;    /* scratch: as many as there are leaves */
} parts_body;

/* ---- which part ---- */

/* The part of the element with these copies */
static inline uint32_t parts_of_copies(const parts_body *p, uint32_t element, const uint32_t copies[4]) {
    uint32_t i;
    for (i = p->first[element]; i < p->first[element + 1]; i++)
        if (memcmp(p->model.elements[i].copy, copies, 4 * sizeof *copies) == 0) return i;
    return PARTS_NONE;
}

static inline void parts_label_leaves(parts_body *p) {
    const gx_body *body = p->body;
    uint32_t cell, leaf;
    memset(p->leaf_part, 255, body->leaves.count * sizeof *p->leaf_part);
    for (cell = 0; cell < body->cells.count; cell++) {
        const gxp_cell *c = &body->cells.data[cell];
        if (!c->kept) continue;
        for (leaf = c->first_leaf; leaf != UINT32_MAX; leaf = body->leaves.data[leaf].next)
            p->leaf_part[leaf] = parts_of_copies(p, c->element, c->copies);
    }
}

static inline parts_body parts_create(gx_body *body) {
    parts_body p;
    size_t i;
    memset(&p, 0, sizeof p);
    p.body = body;
    part_expect(gx_body_model(body, &p.model, NULL));
    p.first = (uint32_t *)dense_memory(NULL, (size_t)body->mesh.element_count + 1, sizeof *p.first);
    p.leaf_part = (uint32_t *)dense_memory(NULL, body->leaves.count, sizeof *p.leaf_part);
    p.leaves = (uint32_t *)dense_memory(NULL, body->leaves.count, sizeof *p.leaves);
    memset(p.first, 0, ((size_t)body->mesh.element_count + 1) * sizeof *p.first);
    for (i = 0; i < p.model.element_count; i++) p.first[p.model.elements[i].group + 1]++;
    for (i = 0; i < body->mesh.element_count; i++) p.first[i + 1] += p.first[i];
    parts_label_leaves(&p);
    return p;
}

static inline void parts_free(parts_body *p) {
    free(p->first);
    free(p->leaf_part);
    free(p->leaves);
    memset(p, 0, sizeof *p);
}

static inline const double *parts_corner(const parts_body *p, uint32_t element, int k) {
    return p->body->mesh.positions + 3 * (size_t)p->body->complex->elements[4 * (size_t)element + (size_t)k];
}

/* Volume of the uncut element, m3 */
static inline double parts_whole(const parts_body *p, uint32_t element) {
    double corners[12];
    int k;
    for (k = 0; k < 4; k++) memcpy(corners + 3 * k, parts_corner(p, element, k), 3 * sizeof(double));
    return gxi_tet_volume(corners);
}

/* The part of the element that contains the material point; PARTS_NONE: removed */
static inline uint32_t parts_find(const parts_body *p, uint32_t element, const double x[3]) {
    const gxb_complex *cx = p->body->complex;
    uint32_t at = cx->root[element];
    double in[3];
    int k;
    for (k = 0; k < 3; k++) in[k] = ldexp(x[k] - cx->store.origin[k], cx->store.shift);
    while (at & 1) {
        const gxb_node *node = &cx->nodes[at >> 1];
        const gxb_plane_filter *f = &cx->store.planes[node->plane].filter;
        double side = 0;
        for (k = 0; k < 3; k++) side += f->n[k] * (in[k] - f->base[k]);
        at = node->child[side < 0];
    }
    return p->leaf_part[at >> 1];
}

/* From the element's reference coordinates, lambda 1, 2, 3 */
static inline void parts_material_point(const parts_body *p, uint32_t element, const double *at, double x[3]) {
    const double *corner = parts_corner(p, element, 0);
    int a, k;
    for (a = 0; a < 3; a++)
        for (x[a] = corner[a], k = 0; k < 3; k++) x[a] += at[k] * (parts_corner(p, element, k + 1)[a] - corner[a]);
}

/* The centre of a part from its mass; 0: it has none */
static inline int parts_center(const parts_body *p, const gxs_element *from, uint32_t element, double x[3]) {
    static const int row[3][4] = {{1, 4, 5, 6}, {2, 5, 7, 8}, {3, 6, 8, 9}};
    double at[3] = {0, 0, 0}, mass = from->mass[0] + from->mass[1] + from->mass[2] + from->mass[3];
    int i, j;
    for (i = 0; i < 3; i++)
        for (j = 0; j < 4; j++) at[i] += from->mass[row[i][j]];
    for (i = 0; i < 3; i++) mass += at[i];
    if (!(mass > 0)) return 0;
    for (i = 0; i < 3; i++) at[i] /= mass;
    parts_material_point(p, element, at, x);
    return 1;
}

/* ---- integrals by points ---- */

/* In the reference frame of one element */
typedef struct parts_element {
    const parts_body *of;
    uint32_t element;
} parts_element;

static inline int parts_number(const void *user, const double *at) {
    const parts_element *e = (const parts_element *)user;
    double x[3];
    uint32_t found;
    parts_material_point(e->of, e->element, at, x);
    found = parts_find(e->of, e->element, x);
    return found == PARTS_NONE ? SAMPLING_OUTSIDE : (int)(found - e->of->first[e->element]);
}

/* Volume and mass of an element from moments in the reference frame */
static inline void parts_fill(const gxi_moments2 *m, double whole, double density, gxs_element *e) {
    e->weight = fmax(0, 6 * whole * m->volume);
    gxi_part_mass(m, 0, whole, density, e->mass);
    rx_clear_negative(e->mass);
}

static inline void parts_add_point(gxi_moments2 *m, const double *point) {
    size_t at = 0, i, j;
    m->volume += point[3];
    for (i = 0; i < 3; i++) {
        m->first[i] += point[3] * point[i];
        for (j = i; j < 3; j++) m->second[at++] += point[3] * point[i] * point[j];
    }
}

/* A rule for all parts of an element; knob: cells, depth or degree */
typedef void (*parts_rule_fn)(const parts_body *p, uint32_t element, double density, int knob, sampling_rule *rule);

static inline sampling_region parts_region(const parts_element *e) {
    sampling_region region;
    region.part_of = parts_number;
    region.user = e;
    return region;
}

static inline void parts_regular(const parts_body *p, uint32_t element, double density, int cells,
                                 sampling_rule *rule) {
    const parts_element e = {p, element};
    const sampling_region region = parts_region(&e);
    (void)density;
    sampling_regular(&region, cells, rule);
}

static inline void parts_adaptive(const parts_body *p, uint32_t element, double density, int depth,
                                  sampling_rule *rule) {
    const parts_element e = {p, element};
    const sampling_region region = parts_region(&e);
    (void)density;
    sampling_adaptive(&region, 2, depth, rule);
}

/* The library's moments of a part, in the reference frame and the order of gxi_polyhedron_monomials: mass is 6 density
   volume int lambda_i lambda_j */
static inline void parts_moments(const gxs_element *of, double whole, double density, double m[10]) {
    static const int row[3][4] = {{1, 4, 5, 6}, {2, 5, 7, 8}, {3, 6, 8, 9}}, second[6] = {4, 5, 6, 7, 8, 9};
    const double scale = 1 / (6 * whole * density);
    int i, j;
    m[0] = of->weight / (6 * whole);
    for (i = 0; i < 3; i++)
        for (m[1 + i] = 0, j = 0; j < 4; j++) m[1 + i] += scale * of->mass[row[i][j]];
    for (i = 0; i < 6; i++) m[4 + i] = scale * of->mass[second[i]];
}

/* The leaves of a part in the form of bench/part.h; borrowed until the next call */
static inline part parts_shape(const parts_body *p, uint32_t element, uint32_t index) {
    const gx_body *body = p->body;
    uint32_t cell, leaf;
    part shape;
    memset(&shape, 0, sizeof shape);
    shape.complex = body->complex;
    shape.element = element;
    shape.leaves = p->leaves;
    for (cell = element; cell != UINT32_MAX; cell = body->cells.data[cell].next) {
        if (!body->cells.data[cell].kept || parts_of_copies(p, element, body->cells.data[cell].copies) != index)
            continue;
        for (leaf = body->cells.data[cell].first_leaf; leaf != UINT32_MAX; leaf = body->leaves.data[leaf].next)
            shape.leaves[shape.leaf_count++] = leaf;
    }
    return shape;
}

static inline void parts_positive(const parts_body *p, uint32_t element, double density, int degree,
                                  sampling_rule *rule) {
    sampling_rule one;
    uint32_t i;
    size_t k;
    memset(&one, 0, sizeof one);
    rule->count = 0;
    for (i = p->first[element]; i < p->first[element + 1]; i++) {
        double moments[10];
        part shape = parts_shape(p, element, i);
        part_shape inside = part_tetrahedra(&shape);
        parts_moments(&p->model.elements[i], parts_whole(p, element), density, moments);
        sampling_positive(inside.corners, inside.count, (unsigned)degree, moments, &one);
        for (k = 0; k < one.count; k++) {
            sampling_add(rule, one.points[4 * k], one.points[4 * k + 1], one.points[4 * k + 2], one.points[4 * k + 3]);
            rule->parts[rule->count - 1] = (int)(i - p->first[element]);
        }
        free(inside.corners);
    }
    sampling_free(&one);
}

/* The model's elements with weights and masses by a rule in each divided element; counts (by part): the rule's
   points, 1 in other elements */
static inline void parts_integrate(const parts_body *p, parts_rule_fn make, int knob, double density,
                                   gxs_element *elements, size_t *counts) {
    sampling_rule rule;
    uint32_t e, i;
    size_t k;
    memset(&rule, 0, sizeof rule);
    memcpy(elements, p->model.elements, p->model.element_count * sizeof *elements);
    for (e = 0; e < p->body->mesh.element_count; e++) {
        const uint32_t first = p->first[e], count = p->first[e + 1] - first;
        gxi_moments2 *moments;
        for (i = 0; i < count; i++) counts[first + i] = count == 1;
        if (count < 2) continue;
        moments = (gxi_moments2 *)dense_memory(NULL, count, sizeof *moments);
        memset(moments, 0, count * sizeof *moments);
        make(p, e, density, knob, &rule);
        for (k = 0; k < rule.count; k++) {
            parts_add_point(&moments[rule.parts[k]], rule.points + 4 * k);
            counts[first + (uint32_t)rule.parts[k]]++;
        }
        for (i = 0; i < count; i++) parts_fill(&moments[i], parts_whole(p, e), density, &elements[first + i]);
        free(moments);
    }
    sampling_free(&rule);
}

/* The same by RXFEM's rules, for a mesh that it has cut by the same surfaces. Each part takes the piece with its
   centre. */
static inline void parts_rxfem(const parts_body *p, const rx_body *b, double density, gxs_element *elements,
                               size_t *counts) {
    size_t i;
    memcpy(elements, p->model.elements, p->model.element_count * sizeof *elements);
    for (i = 0; i < p->model.element_count; i++) {
        const uint32_t e = elements[i].group;
        gxi_moments2 m;
        double x[3];
        const rx_piece *piece;
        counts[i] = 1;
        if (p->first[e + 1] - p->first[e] < 2 || !parts_center(p, &p->model.elements[i], e, x)) continue;
        piece = &b->pieces[rx_piece_at(b, e, x)];
        m.volume = piece->moments[0];
        memcpy(m.first, piece->moments + 1, sizeof m.first);
        memcpy(m.second, piece->moments + 4, sizeof m.second);
        parts_fill(&m, parts_whole(p, e), density, &elements[i]);
        counts[i] = b->rules->volume.point_count;
    }
}

/* ---- element deletion ---- */

/* Does a cut meet the element's inside? */
static inline int parts_is_met(const gx_body *body, uint32_t element) {
    return (int)(body->complex->root[element] & 1);
}

/* Whole elements on uncut nodes; returns the number that is left. elements: room for those of the mesh. uncut: its
   model before any cut */
static inline size_t parts_delete(const parts_body *p, const gxs_model *uncut, gxs_element *elements) {
    size_t i, count = 0;
    for (i = 0; i < uncut->element_count; i++)
        if (!parts_is_met(p->body, uncut->elements[i].group)) elements[count++] = uncut->elements[i];
    return count;
}

#endif
