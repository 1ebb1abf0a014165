/* bits.c - a body that is cut and stepped, for test_python.py: prints hashes of it. Both programs must print the same. */
#include <stdio.h>
#include <string.h>
#include "gxfem.h"

int main(void) {
    static const double positions[24] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 0, 0, 0, 1, 1, 0, 1, 0, 1, 1, 1, 1, 1};
    static const uint32_t elements[20] = {0, 1, 2, 4, 3, 1, 7, 2, 5, 1, 4, 7, 6, 2, 7, 4, 1, 2, 4, 7};
    static const double vertices[12] = {-1, -1, 0.4, 3, -1, 0.45, 3, 3, 0.5, -1, 3, 0.5};
    static const uint32_t triangles[6] = {0, 1, 2, 0, 2, 3};
    gx_body_desc desc;
    gx_surface sheet;
    gx_cut_desc cut;
    gx_step_desc step;
    gx_region held = gx_region_half_space(2, -1, 0.1);
    gx_body *body = NULL;
    gx_view view;
    int i, failed = 0;
    memset(&desc, 0, sizeof desc);
    memset(&sheet, 0, sizeof sheet);
    memset(&cut, 0, sizeof cut);
    memset(&step, 0, sizeof step);
    desc.positions = positions;
    desc.node_count = 8;
    desc.elements = elements;
    desc.element_count = 5;
    desc.young = 3e3;
    desc.poisson = 0.35;
    desc.density = 800;
    sheet.vertices = vertices;
    sheet.vertex_count = 4;
    sheet.triangles = triangles;
    sheet.triangle_count = 2;
    cut.surfaces = &sheet;
    cut.surface_count = 1;
    step.dt = 1.0 / 60;
    step.gravity[2] = -9.81;
    step.integrator = GXS_BDF2;
    failed |= gx_body_create(&desc, &body, NULL) != GX_OK || gx_body_hold(body, &held, 1, NULL) != GX_OK;
    for (i = 0; i < 10 && !failed; i++) {
        if (i == 3) failed |= gx_body_cut(body, &cut, NULL, NULL) != GX_OK;
        failed |= gx_body_step(body, &step, NULL, NULL) != GX_OK;
    }
    failed |= failed || gx_body_view(body, &view, NULL) != GX_OK;
    if (!failed) {
        const unsigned long long topology = gx_body_topology_hash(body, NULL);
        printf("%016llx %016llx\n", topology, (unsigned long long)gx_body_state_hash(body));
        for (i = 0; i < (int)(3 * view.copy_count); i++) printf("%a\n", view.displacement[i]);
    }
    gx_body_destroy(body);
    return failed;
}
