/* pieces.h - bodies of closed surfaces beside the surfaces: the skin's area, the pieces that Booleans make of them.
   Include after the implementation of gxfem.h. */
#ifndef GXFEM_TESTS_PIECES_H
#define GXFEM_TESTS_PIECES_H

#include "body.h"
#include "models.h"

static inline double area_of_skin(gx_body *body) {
    gx_skin skin;
    memset(&skin, 0, sizeof skin);
    ck_assert_int_eq(gx_body_skin(body, NULL, &skin, NULL), GX_OK);
    return area_of_triangles(skin.vertex_rest, skin.triangles, skin.triangle_count);
}

static inline int ascending(const void *a, const void *b) {
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

/* Sorts both. whole: the volume of all */
static inline void expect_same_volumes(double *own, double *exact, size_t count, double whole, const char *what) {
    size_t i;
    qsort(own, count, sizeof *own, ascending);
    qsort(exact, count, sizeof *exact, ascending);
    for (i = 0; i < count; i++)
        ck_assert_msg(fabs(own[i] - exact[i]) <= 1e-10 * exact[i] + 1e-13 * whole, "%s: volume %.17g, should be %.17g",
                      what, own[i], exact[i]);
}

/* Volumes of the components of the union of all surfaces, split by a sheet or NULL. Returns their number. */
static inline size_t boolean_volumes(const workload *w, const gx_surface *sheet, double *volumes, size_t most) {
    gxb_boolean *b = NULL;
    gxb_boolean_result result;
    gxb_components components;
    size_t i;
    ck_assert_int_eq(gxb_boolean_create(NULL, &b, NULL), GX_OK);
    ck_assert_int_eq(gxb_boolean_set_fine(b, 1, NULL), GX_OK);
    for (i = 0; i < w->surface_count + (sheet != NULL); i++) {
        const gx_surface s = i < w->surface_count ? surface_of(&w->surfaces[i]) : *sheet;
        gxb_operand operand;
        memset(&operand, 0, sizeof operand);
        operand.vertices = s.vertices;
        operand.vertex_count = s.vertex_count;
        operand.triangles = s.triangles;
        operand.triangle_count = s.triangle_count;
        operand.operation = i < w->surface_count ? GXB_UNION : GXB_SPLIT;
        ck_assert_int_eq(gxb_boolean_add(b, &operand, NULL), GX_OK);
    }
    ck_assert_int_eq(gxb_boolean_evaluate(b, &result, NULL), GX_OK);
    ck_assert_int_eq(gxb_boolean_components(b, &components, NULL), GX_OK);
    ck_assert_uint_le(components.count, most);
    memcpy(volumes, components.volume, components.count * sizeof *volumes);
    i = components.count;
    gxb_boolean_destroy(b);
    return i;
}

/* Fragments of a body of the surfaces that a sheet, or NULL, has cut: as many as of the Boolean, of the same volumes */
static inline void expect_pieces(gx_body *body, const workload *w, const gx_surface *sheet, const char *what) {
    enum { MOST_PIECES = 4096 };
    static double own[MOST_PIECES], exact[MOST_PIECES];
    const gx_view view = view_of(body);
    const size_t count = boolean_volumes(w, sheet, exact, MOST_PIECES);
    ck_assert_msg(view.fragment_count == count, "%s: %zu fragments, should be %zu", what, view.fragment_count, count);
    memcpy(own, view.fragment_volume, count * sizeof *own);
    expect_same_volumes(own, exact, count, view.volume, what);
}

#endif /* GXFEM_TESTS_PIECES_H */
