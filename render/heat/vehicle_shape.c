/* render/heat/vehicle_shape.c: the thermal network of a model, made from its patches and parts
 * (vehicle_load_private.h). */
#include "render/heat/vehicle_load_private.h"

#include <stdlib.h>

enum { skin_depths = 4 };

/* Depths of the nodes of a thick skin, shares of its thickness: dense where weather drives it, even where shots do. */
static const double depth_of[2][skin_depths] = {{0, 0.1, 0.35, 1}, {0, 1.0 / 3, 2.0 / 3, 1}};
static const double joint_share = 1.0 / 3;
static const double bulkhead_s = 6e4; /* heat capacity of the engine over its conductance to the cabin; estimate */

static bool is_thick(const PartRow *row, const Material *m)
{
    static const double film_w_m2k = 25, most_biot = 0.1;
    return row->drive == PART_DRIVE_FIRING || film_w_m2k * row->thickness_m > most_biot * (double)m->conductivity_w_mk;
}

static double rho_c(const Material *m) { return (double)m->density_kg_m3 * (double)m->heat_capacity_j_kgk; }

/* Nodes and links through one skin. */
static void add_skin(VehicleShape *s, SkinNode *skin, const Material *m)
{
    const PartRow *row = &skin->row;
    const double   area = skin->area_m2, t = row->thickness_m, capacity = rho_c(m) * t * area;
    skin->surface = skin->inner = s->nodes;
    if (!is_thick(row, m)) {
        s->capacity_j_k[s->nodes++] = capacity;
        return;
    }
    const double *depth = depth_of[row->drive == PART_DRIVE_FIRING];
    for (int i = 0; i < skin_depths; i++) {
        const double above = i > 0 ? depth[i] - depth[i - 1] : 0,
                     below = i + 1 < skin_depths ? depth[i + 1] - depth[i] : 0;
        s->capacity_j_k[s->nodes++] = 0.5 * (above + below) * capacity;
        if (i > 0)
            s->link[s->links++] =
                (NetworkLink){s->nodes - 2, s->nodes - 1, (double)m->conductivity_w_mk * area / (above * t)};
    }
    skin->inner = s->nodes - 1;
}

static const Material *material_at(const Materials *materials, int index, const Patch *patch)
{
    return &materials->material[material_of_part(materials, index, patch->part, 0)];
}

static void add_skins(VehicleShape *s, const Model *model, int index, const PartTable *table,
                      const Materials *materials)
{
    static const double rubber_w_mk = 1, stiff_share = 0.2;
    const Patches      *p = s->patches;
    for (int i = 0; i < p->count; i++) {
        const Material *m = material_at(materials, index, &p->patch[i]);
        SkinNode       *skin = &s->skin[i];
        const PartRow  *row = &table->role[p->patch[i].role];
        const bool      yields = (double)m->conductivity_w_mk < rubber_w_mk || p->patch[i].role == HEAT_TRACK;
        *skin = (SkinNode){.row = *row,
                           .inside_link = -1,
                           .area_m2 = patch_skin_m2(&p->patch[i]),
                           .open_m2 = patch_open_m2(&p->patch[i]),
                           .effusivity = sqrt((double)m->conductivity_w_mk * rho_c(m)),
                           .absorptance = (double)m->solar_absorptance,
                           .emissivity = 1 - (double)m->rho_lwir,
                           .friction = yields ? 1 : stiff_share};
        const double own_m = model->part[p->patch[i].part].thickness_m;
        if (own_m > 0) skin->row.thickness_m = own_m;
        add_skin(s, skin, m);
    }
    for (int k = 0; k < p->links; k++) {
        const PatchLink *l = &p->link[k];
        double           sheet = INFINITY;
        const int        end[2] = {l->a, l->b};
        for (int e = 0; e < 2; e++)
            sheet = fmin(sheet, (double)material_at(materials, index, &p->patch[end[e]])->conductivity_w_mk *
                                    s->skin[end[e]].row.thickness_m);
        const double w_k = sheet * l->length_m / l->distance_m * (l->joint ? joint_share : 1);
        s->link[s->links++] = (NetworkLink){s->skin[l->a].surface, s->skin[l->b].surface, w_k};
    }
}

/* Links to engine and cabin, of the conductance of the moment. */
static void add_insides(VehicleShape *s)
{
    bool any[INSIDE_COUNT] = {false};
    for (int i = 0; i < s->patches->count; i++) any[s->skin[i].row.inside] = true;
    s->engine = s->cabin = -1;
    if (any[INSIDE_ENGINE]) s->engine = s->nodes, s->capacity_j_k[s->nodes++] = s->machine.engine_j_k;
    if (any[INSIDE_CABIN]) s->cabin = s->nodes, s->capacity_j_k[s->nodes++] = s->machine.cabin_j_k;
    for (int i = 0; i < s->patches->count; i++) {
        const int node = s->skin[i].row.inside == INSIDE_ENGINE  ? s->engine
                         : s->skin[i].row.inside == INSIDE_CABIN ? s->cabin
                                                                 : -1;
        if (node < 0) continue;
        s->skin[i].inside_link = s->links;
        s->link[s->links++] = (NetworkLink){s->skin[i].inner, node, s->skin[i].row.inside_w_m2k * s->skin[i].area_m2};
    }
    if (s->engine < 0 || s->cabin < 0) return;
    s->link[s->links++] = (NetworkLink){s->engine, s->cabin, s->machine.engine_j_k / bulkhead_s};
}

/* Fuel, in tanks along hull or airframe. */
static void add_fuel(VehicleShape *s)
{
    static const double touched_share = 0.1,
                        film_w_m2k = 30; /* of the skin; natural convection in oil behind it; estimates */
    s->fuel = s->fuel_link = -1;
    if (!(s->machine.fuel_j_k > 0)) return;
    for (int i = 0; i < s->patches->count; i++) {
        const HeatRole role = s->patches->patch[i].role;
        if ((role != HEAT_HULL && role != HEAT_AIRFRAME) || !(s->skin[i].open_m2 > 0)) continue;
        if (s->fuel < 0) s->fuel = s->nodes, s->capacity_j_k[s->nodes++] = s->machine.fuel_j_k;
        s->link[s->links++] = (NetworkLink){s->skin[i].inner, s->fuel, touched_share * film_w_m2k * s->skin[i].area_m2};
    }
    if (s->fuel < 0 || s->engine < 0) return;
    s->fuel_link = s->links;
    s->link[s->links++] = (NetworkLink){s->engine, s->fuel, s->machine.fuel_w_k};
}

/* What tracks and wheels have on the ground. */
static void find_prints(VehicleShape *s)
{
    const Patches *p = s->patches;
    for (int b = 0; b < p->bodies; b++) {
        const int first = p->first_of_body[b], end = p->first_of_body[b + 1];
        double    ground_m2 = 0, open_m2 = 0;
        if (first == end || (p->patch[first].role != HEAT_TRACK && p->patch[first].role != HEAT_WHEEL)) continue;
        for (int i = first; i < end; i++) ground_m2 += p->patch[i].ground_m2, open_m2 += s->skin[i].open_m2;
        if (!(ground_m2 > 0)) continue;
        for (int i = first; i < end; i++) {
            s->skin[i].ground_m2 = p->patch[i].ground_m2;
            s->skin[i].rolls_m2 = ground_m2 * s->skin[i].open_m2 / open_m2;
            s->skin[i].print_m = sqrt(ground_m2);
        }
    }
}

/* The smallest and the largest of its guns, by area. */
static void find_guns(VehicleShape *s)
{
    const Patches *p = s->patches;
    s->gun_body[0] = s->gun_body[1] = -1;
    for (int b = 0; b < p->bodies; b++) {
        const int first = p->first_of_body[b];
        double    m2 = 0;
        if (first == p->first_of_body[b + 1] || s->skin[first].row.drive != PART_DRIVE_FIRING) continue;
        for (int i = first; i < p->first_of_body[b + 1]; i++) m2 += s->skin[i].area_m2;
        for (int large = 0; large < 2; large++) {
            if (s->gun_body[large] >= 0 && (large ? m2 <= s->gun_m2[1] : m2 >= s->gun_m2[0])) continue;
            s->gun_body[large] = b;
            s->gun_m2[large] = m2;
        }
    }
}

Status vehicle_shape_create(VehicleShape *out, const Patches *patches, const Model *model, int index,
                            const PartTable *table, const Materials *materials)
{
    const size_t nodes = (size_t)patches->count * skin_depths + 3,
                 links = nodes + (size_t)patches->links + 2 * (size_t)patches->count + 2;
    VehicleShape s = {.patches = patches, .machine = part_table_machine(table, model)};
    Status       status = STATUS_NO_MEMORY;
    s.capacity_j_k = calloc(nodes, sizeof *s.capacity_j_k);
    s.link = calloc(links, sizeof *s.link);
    s.conductance_w_k = calloc(links, sizeof *s.conductance_w_k);
    s.skin = calloc((size_t)patches->count + 1, sizeof *s.skin);
    if (s.capacity_j_k && s.link && s.conductance_w_k && s.skin) {
        add_skins(&s, model, index, table, materials);
        add_insides(&s);
        add_fuel(&s);
        find_prints(&s);
        find_guns(&s);
        status = heat_network_create(&s.network, &(NetworkShape){s.nodes, s.links, 0, s.capacity_j_k, s.link, NULL});
    }
    if (status == STATUS_OK) *out = s;
    else vehicle_shape_destroy(&s);
    return status;
}

void vehicle_shape_destroy(VehicleShape *s)
{
    heat_network_destroy(s->network);
    free(s->capacity_j_k);
    free(s->link);
    free(s->conductance_w_k);
    free(s->skin);
    *s = (VehicleShape){0};
}
