#include "entities/parametric.h"

#include "entities/mesh_builder.h"

/* What stands in for a type that nobody described: 4 m long, 2 m wide, 1.6 m high, of a light vehicle's size.
 * The front is a ramp that falls forward, a fin stands at the rear on top and a block lies on the right:
 * forward, up and right can be told apart from any side. */
static Status parametric_unknown(Model *out, double sag_m)
{
    static const double side[5][2] = {{-2, -0.2}, {-2, -1.2}, {0.8, -1.2}, {2, -0.5}, {2, -0.2}};
    static const double fin[3][2]  = {{-1.9, -1.15}, {-1.9, -1.6}, {-0.7, -1.15}};
    MeshBuilder *b = mesh_builder_create("unknown", sag_m);
    if (!b) return STATUS_NO_MEMORY;
    const int hull = mesh_node(b, "hull", -1, 0, 0, 0);
    mesh_part(b, hull, "body", "paint_grey", HEAT_HULL);
    mesh_prism(b, place_at(0, 0, 0), 5, side, -1, 1);
    mesh_prism(b, place_at(0, 0, 0), 3, fin, -0.06, 0.06);
    mesh_box(b, place_at(0, 0, 0), -0.9, 0.55, -1.4, 0.1, 0.95, -1.15);
    mesh_part(b, hull, "base", "rubber_black", HEAT_PASSIVE);
    mesh_box(b, place_at(0, 0, 0), -1.8, -0.8, -0.25, 1.8, 0.8, 0);
    return mesh_builder_finish(out, b);
}

/* A block with a metal plate on the front half of its right side alone, for finding out whether a picture is
 * where it should be, and neither mirrored nor rolled: the plate differs from the block in every band (in the
 * thermal ones when the engine runs: the block is hot and black, the plate bare metal). */
static Status parametric_marker(Model *out, double sag_m)
{
    MeshBuilder *b = mesh_builder_create("marker", sag_m);
    if (!b) return STATUS_NO_MEMORY;
    const int hull = mesh_node(b, "hull", -1, 0, 0, 0);
    mesh_part(b, hull, "block", "rubber_black", HEAT_ENGINE_DECK);
    mesh_box(b, place_at(0, 0, 0), -2, -1, -1.5, 2, 1, 0);
    mesh_part(b, hull, "plate", "metal_aluminium_bare", HEAT_PASSIVE);
    mesh_box(b, place_at(0, 0, 0), 0.1, 1, -1.4, 1.9, 1.0001, -0.3);
    return mesh_builder_finish(out, b);
}

static const struct {
    const char *name;
    Status (*build)(Model *out, double sag_m);
} builders[] = {
    {"tank", parametric_tank},       {"truck", parametric_truck},     {"helicopter", parametric_helicopter},
    {"missile", parametric_missile}, {"carrier", parametric_carrier}, {"launcher", parametric_launcher},
    {"aircraft", parametric_aircraft}, {"ship", parametric_ship},     {"person", parametric_person},
    {"building", parametric_building}, {"decoy", parametric_decoy},   {"flare", parametric_flare},
    {"unknown", parametric_unknown}, {"marker", parametric_marker},
};

static int find_builder(const char *name)
{
    for (size_t i = 0; i < sizeof builders / sizeof *builders; i++)
        if (strcmp(name, builders[i].name) == 0) return (int)i;
    return -1;
}

bool parametric_known(const char *name) { return find_builder(name) >= 0; }

Status parametric_build(Model *out, const char *name, double sag_m)
{
    if (!(sag_m >= 1e-5 && sag_m <= 0.1)) {
        log_error("parametric: sag out of range: model=%s sag_m=%g range=1e-5..0.1", name, sag_m);
        return STATUS_BAD_VALUE;
    }
    const int builder = find_builder(name);
    if (builder >= 0) return builders[builder].build(out, sag_m);
    log_error("parametric: no such model: name=%s", name);
    return STATUS_UNSUPPORTED;
}
