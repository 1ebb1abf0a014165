/* Uses the installed headers: prints the version and what cutting a tetrahedron in two gives. */
#define GXFEM_IMPLEMENTATION
#include <gxfem.h>
#include <stdio.h>

int main(void) {
    const double x[12] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1}, s[9] = {-9, -9, .25, 9, -9, .25, 0, 9, .25};
    const uint32_t tet[4] = {0, 1, 2, 3}, tri[3] = {0, 1, 2};
    gx_body_desc desc = {0};
    gx_surface sheet = {0};
    gx_cut_desc cut = {0};
    gx_view view = {0};
    gx_body *body = NULL;
    gx_result result;
    desc.positions = x;
    desc.node_count = 4;
    desc.elements = tet;
    desc.element_count = 1;
    desc.young = 1e6;
    desc.poisson = 0.4;
    desc.density = 1000;
    sheet.vertices = s;
    sheet.vertex_count = 3;
    sheet.triangles = tri;
    sheet.triangle_count = 1;
    cut.surfaces = &sheet;
    cut.surface_count = 1;
    result = gx_body_create(&desc, &body, NULL);
    if (result == GX_OK) result = gx_body_cut(body, &cut, NULL, NULL);
    if (result == GX_OK) result = gx_body_view(body, &view, NULL);
    printf("gxfem %d.%d.%d, %u fragments\n", GXFEM_VERSION_MAJOR, GXFEM_VERSION_MINOR, GXFEM_VERSION_PATCH,
           (unsigned)view.fragment_count);
    gx_body_destroy(body);
    return result != GX_OK;
}
