/* organ.h: a liver of three materials as closed surfaces, for the scenes `organ` and `trainer`: flesh, a stiffer vessel
   in it, and a tumour at the front that stands out a little. Include it in place of scene.h. */
#ifndef ORGAN_H
#define ORGAN_H

#include "gxshape.h"
#include "scene.h"

enum { FLESH, VESSEL, TUMOUR, MATERIALS };

/* The field's surface, with triangles of about `spacing`, m */
static inline gxio_surface organ_surface(scene *s, gxshape_field *field, const gxshape_part *parts, size_t count,
                                         double spacing) {
    const double low[3] = {-0.2, -0.2, -0.2}, high[3] = {0.2, 0.2, 0.2};
    gxio_surface surface;
    gxshape_mesh made;
    gxio_mesh mesh;
    const char *wrong;
    memset(field, 0, sizeof *field);
    gxshape_add(field, parts, count);
    wrong = gxshape_stuff(gxshape_field_value, field, low, high, spacing, &made);
    if (wrong) scene_misuse(s, "surface", wrong);
    memset(&mesh, 0, sizeof mesh);
    mesh.positions = made.positions;
    mesh.node_count = made.node_count;
    mesh.elements = made.elements;
    mesh.element_count = made.element_count;
    surface = scene_surface_of(s, &mesh);
    gxshape_mesh_release(&made);
    return surface;
}

static inline void organ_surfaces(scene *s, gxio_surface surfaces[MATERIALS]) {
    const double spacing = s->small ? 0.02 : 0.009;
    const gxshape_part flesh[3] = {
        {GXSHAPE_ELLIPSOID, {-0.035, 0.0, 0.0}, {0.085, 0.075, 0.05}, {0, 0}, 0.0},
        {GXSHAPE_ELLIPSOID, {0.05, 0.01, -0.005}, {0.08, 0.055, 0.035}, {0, 0}, 0.03},
        {GXSHAPE_CAPSULE, {-0.07, -0.03, -0.02}, {-0.03, -0.045, -0.02}, {0.03, 0.028}, 0.02}};
    const gxshape_part vessel[2] = {{GXSHAPE_CAPSULE, {-0.07, 0.02, 0.0}, {0.0, 0.025, 0.0}, {0.012, 0.011}, 0.0},
                                    {GXSHAPE_CAPSULE, {0.0, 0.025, 0.0}, {0.09, 0.015, -0.005}, {0.011, 0.009}, 0.005}};
    const gxshape_part tumour[2] = {
        {GXSHAPE_CAPSULE, {-0.04, -0.05, 0.03}, {-0.04, -0.05, 0.03}, {0.024, 0.024}, 0.0},
        {GXSHAPE_CAPSULE, {-0.02, -0.055, 0.025}, {-0.02, -0.055, 0.025}, {0.018, 0.018}, 0.01}};
    gxshape_field field;
    surfaces[FLESH] = organ_surface(s, &field, flesh, 3, spacing);
    surfaces[VESSEL] = organ_surface(s, &field, vessel, 2, 0.6 * spacing);
    surfaces[TUMOUR] = organ_surface(s, &field, tumour, 2, 0.7 * spacing);
}

static inline gx_material organ_material(double young, double poisson, double density) {
    gx_material material;
    memset(&material, 0, sizeof material);
    material.elastic.kind = GXS_STABLE_NEO_HOOKEAN;
    material.elastic.young = young;
    material.elastic.poisson = poisson;
    material.density = density;
    return material;
}

/* Volume of each material, m3, in a fragment or, UINT32_MAX, in all */
static inline void organ_measure(const scene *s, uint32_t fragment, double volume[MATERIALS]) {
    size_t c;
    int m;
    for (m = 0; m < MATERIALS; m++) volume[m] = 0.0;
    for (c = 0; c < s->view.cell_count; c++)
        if (fragment == UINT32_MAX || s->view.cell_fragment[c] == fragment)
            volume[s->view.cell_material[c]] += s->view.cell_volume[c];
}

/* The fragment that has the most of a material */
static inline uint32_t organ_fragment(const scene *s, uint32_t material) {
    double volume[MATERIALS], most = -1.0;
    uint32_t f, best = 0;
    for (f = 0; f < s->view.fragment_count; f++) {
        organ_measure(s, f, volume);
        if (volume[material] > most) best = f;
        most = fmax(most, volume[material]);
    }
    return best;
}

/* The body, a grid of so many cubes along its longest side */
static inline void organ_make(scene *s, const gxio_surface surfaces[MATERIALS], uint32_t cells) {
    gx_material materials[MATERIALS];
    materials[FLESH] = organ_material(2e4, 0.45, 1050.0);
    materials[VESSEL] = organ_material(2e5, 0.4, 1100.0);
    materials[TUMOUR] = organ_material(6e4, 0.45, 1150.0);
    s->body_desc.materials = materials;
    s->body_desc.material_count = MATERIALS;
    scene_make_of(s, surfaces, MATERIALS, cells);
    s->body_desc.materials = NULL;
}

#endif /* ORGAN_H */
