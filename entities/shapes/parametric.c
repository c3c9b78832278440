/* entities/shapes/parametric.c: the list of built-in models, and which of them fits a type. */
#include "entities/shapes/parametric.h"

#include "entities/shapes/mesh_builder.h"

/* Default shape of an unknown type: 4 m long, 2 m wide, 1.6 m high, of a light vehicle's size.
 * The front is a ramp that falls forward, a fin stands at the rear on top and a block lies on the right:
 * forward, up and right can be distinguished from any side. */
static Status parametric_unknown(Model *out, double sag_m)
{
    static const double side[5][2] = {{-2, -0.2}, {-2, -1.2}, {0.8, -1.2}, {2, -0.5}, {2, -0.2}};
    static const double fin[3][2] = {{-1.9, -1.15}, {-1.9, -1.6}, {-0.7, -1.15}};
    MeshBuilder        *b = mesh_builder_create("unknown", sag_m);
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

typedef Status (*FamilyBuild)(Model *out, const char *name, double sag_m);

static const struct {
    const char *name;
    Status (*build)(Model *out, double sag_m);
    FamilyBuild family; /* instead: a file that holds several shapes */
} builders[] = {
    {"tank", parametric_tank, NULL},
    {"truck", parametric_truck, NULL},
    {"helicopter", parametric_helicopter, NULL},
    {"missile", parametric_missile, NULL},
    {"carrier", parametric_carrier, NULL},
    {"launcher", parametric_launcher, NULL},
    {"aircraft", parametric_aircraft, NULL},
    {"ship", parametric_ship, NULL},
    {"person", parametric_person, NULL},
    {"building", parametric_building, NULL},
    {"decoy", parametric_decoy, NULL},
    {"flare", parametric_flare, NULL},
    {"corner_reflector", parametric_corner_reflector, NULL},
    {"unknown", parametric_unknown, NULL},
    {"marker", parametric_marker, NULL},
    {"airliner", NULL, parametric_airplane},
    {"airliner_4", NULL, parametric_airplane},
    {"cargo_plane", NULL, parametric_airplane},
    {"cargo_jet", NULL, parametric_airplane},
    {"bomber", NULL, parametric_airplane},
    {"patrol_plane", NULL, parametric_airplane},
    {"attack_plane", NULL, parametric_airplane},
    {"light_plane", NULL, parametric_airplane},
    {"uav", NULL, parametric_airplane},
    {"car", NULL, parametric_wheeled},
    {"jeep", NULL, parametric_wheeled},
    {"motorcycle", NULL, parametric_wheeled},
    {"robot", NULL, parametric_wheeled},
    {"bus", NULL, parametric_wheeled},
    {"carrier_wheeled", NULL, parametric_wheeled},
    {"truck_heavy", NULL, parametric_wheeled},
    {"semi_trailer", NULL, parametric_wheeled},
    {"trailer", NULL, parametric_wheeled},
    {"shelter", NULL, parametric_wheeled},
    {"rocket_truck", NULL, parametric_wheeled},
    {"rocket_launcher", NULL, parametric_artillery},
    {"howitzer", NULL, parametric_artillery},
    {"bulldozer", NULL, parametric_artillery},
    {"carrier_cargo", NULL, parametric_artillery},
    {"gun", NULL, parametric_artillery},
    {"mortar", NULL, parametric_artillery},
    {"helicopter_utility", NULL, parametric_rotorcraft},
    {"helicopter_tandem", NULL, parametric_rotorcraft},
    {"helicopter_light", NULL, parametric_rotorcraft},
    {"quadcopter", NULL, parametric_rotorcraft},
    {"airship", NULL, parametric_rotorcraft},
    {"boat", NULL, parametric_vessel},
    {"rhib", NULL, parametric_vessel},
    {"aircraft_carrier", NULL, parametric_vessel},
    {"submarine", NULL, parametric_vessel},
    {"cargo_ship", NULL, parametric_vessel},
    {"tanker", NULL, parametric_vessel},
    {"missile_air", NULL, parametric_munition},
    {"missile_cruise", NULL, parametric_munition},
    {"missile_ballistic", NULL, parametric_munition},
    {"bomb", NULL, parametric_munition},
    {"bomb_guided", NULL, parametric_munition},
    {"shell", NULL, parametric_munition},
    {"torpedo", NULL, parametric_munition},
    {"mine", NULL, parametric_munition},
    {"crates", NULL, parametric_structure},
    {"radar", NULL, parametric_structure},
    {"tent", NULL, parametric_structure},
    {"bridge", NULL, parametric_structure},
    {"buoy", NULL, parametric_structure},
    {"satellite", NULL, parametric_structure},
    {"locomotive", NULL, parametric_structure},
    {"railcar", NULL, parametric_structure},
    {"animal", NULL, parametric_structure},
    {"net", NULL, parametric_cover},
    {"wall", NULL, parametric_cover},
    {"none", NULL, parametric_structure},
    {"chaff", NULL, parametric_structure},
    {"van", NULL, parametric_civil},
    {"lorry", NULL, parametric_civil},
    {"tractor", NULL, parametric_civil},
    {"combine", NULL, parametric_civil},
    {"excavator", NULL, parametric_civil},
    {"generator", NULL, parametric_civil},
    {"farm_trailer", NULL, parametric_civil},
    {"wreck", NULL, parametric_civil},
    {"container", NULL, parametric_civil},
    {"cow", NULL, parametric_countryside},
    {"sheep", NULL, parametric_countryside},
    {"deer", NULL, parametric_countryside},
    {"bale", NULL, parametric_countryside},
    {"campfire", NULL, parametric_countryside},
    {"barrel", NULL, parametric_countryside},
    {"smoulder", NULL, parametric_countryside},
    {"rock_1", NULL, parametric_rock},
    {"rock_2", NULL, parametric_rock},
    {"rock_3", NULL, parametric_rock},
};

enum { builder_count = sizeof builders / sizeof *builders };

static int find_builder(const char *name)
{
    for (int i = 0; i < builder_count; i++)
        if (strcmp(name, builders[i].name) == 0) return i;
    return -1;
}

bool        parametric_known(const char *name) { return find_builder(name) >= 0; }
int         parametric_count(void) { return builder_count; }
const char *parametric_name(int index) { return builders[index].name; }

static bool chord_error_is_valid(const char *name, double sag_m)
{
    if (sag_m >= 1e-5 && sag_m <= 0.1) return true;
    log_error("parametric: sag out of range: model=%s sag_m=%g range=1e-5..0.1", name, sag_m);
    return false;
}

static Status build(Model *out, const char *name, double sag_m)
{
    const int k = find_builder(name);
    if (k >= 0) return builders[k].build ? builders[k].build(out, sag_m) : builders[k].family(out, name, sag_m);
    log_error("parametric: no such model: name=%s", name);
    return STATUS_UNSUPPORTED;
}

Status parametric_build(Model *out, const char *name, double sag_m)
{
    return chord_error_is_valid(name, sag_m) ? build(out, name, sag_m) : STATUS_BAD_VALUE;
}

Status parametric_build_size(Model *out, const char *name, const ModelSize *size, double sag_m)
{
    static const double coarsest_m = 0.1, finest_m = 1e-5;
    Model               model = {0};
    double              factor[3];
    if (!size || !(size->length_m > 0 || size->width_m > 0 || size->height_m > 0))
        return parametric_build(out, name, sag_m);
    if (!chord_error_is_valid(name, sag_m)) return STATUS_BAD_VALUE;
    /* once coarsely, for the factors; then with facets within the chord error after scaling */
    Status status = build(&model, name, coarsest_m);
    if (status != STATUS_OK) return status;
    const bool fits = model_scale_to(factor, &model, size);
    model_destroy(&model);
    if (fits) {
        const double largest = fmax(factor[0], fmax(factor[1], factor[2]));
        status = build(&model, name, clamp(sag_m / largest, finest_m, coarsest_m));
        if (status == STATUS_OK) status = model_resize(&model, size);
    }
    if (!fits || status == STATUS_BAD_VALUE) {
        log_error("parametric: too far from the shape's own size: model=%s length_m=%g width_m=%g height_m=%g "
                  "range=0.02..50 times",
                  name, size->length_m, size->width_m, size->height_m);
        status = STATUS_BAD_VALUE;
    }
    if (status != STATUS_OK) {
        model_destroy(&model);
        return status;
    }
    model.sag_m = sag_m;
    *out = model;
    return STATUS_OK;
}
