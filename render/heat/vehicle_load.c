/* render/heat/vehicle_load.c: what heats and cools each node of a model at a moment (vehicle_load_private.h). */
#include "render/heat/vehicle_load_private.h"

#include "render/heat/surface_flux_private.h"

static const double leak_s = 25000;    /* engine that has stopped, and a cabin: to the air through its bay; estimate */
static const double moving_mps = 0.3;  /* above the jitter of reports of a vehicle that stands */
static const double flame_w_m2 = 20e3; /* into the skin of what burns: fires of fuel and rubber inside; estimate */

double vehicle_recovery_k(double speed_mps)
{
    static const double recovery = 0.85, cp_air_j_kgk = 1005;
    return recovery * speed_mps * speed_mps / (2 * cp_air_j_kgk);
}

static double film_at(double speed_mps, double air_density)
{
    return plate_film_w_m2k(speed_mps) * pow(air_density, 0.8);
}

/* Speed of the air past a patch: of the entity, and of blades that turn. */
static double air_speed(const VehicleMoment *m, const Patch *patch, const EntityDrives *drives)
{
    const ModelNode *node = &m->model->node[patch->node];
    double           flow[3], speed_mps;
    v3_sub(flow, m->place.wind_enu_mps, m->v_enu_mps);
    speed_mps = v3_length(flow);
    if (node->spin_rps_moving == 0 || !(drives->engine > 0)) return speed_mps;
    const double along = v3_dot(patch->p_node, node->axis);
    const double radius_m = sqrt(fmax(v3_dot(patch->p_node, patch->p_node) - along * along, 0)) + patch->reach_m;
    return speed_mps + 0.7 * fabs(node->spin_rps_moving) * radius_m; /* most of a blade's area and heat is there */
}

/* A second film of a node: both to one fluid between. */
static void add_film(NetworkLoad *load, double w_k, double fluid_k)
{
    if (!(w_k > 0)) return;
    load->fluid_k = (load->film_w_k * load->fluid_k + w_k * fluid_k) / (load->film_w_k + w_k);
    load->film_w_k += w_k;
}

/* What is behind a skin, where that is no node of the network. */
static void add_inside(NetworkLoad *load, const PartRow *row, const MachineRow *machine, const EntityDrives *d,
                       double area_m2, double air_k)
{
    const double engine = (double)d->engine, alive = (double)d->alive, film = row->inside_w_m2k,
                 running = row->running_w_m2k;
    const double idle = 0.5,
                 gas_k = air_k + (machine->exhaust_k - air_k) *
                                     (idle + (1 - idle) * clamp((engine - drives_idle) / (1 - drives_idle), 0, 1));
    switch (row->inside) {
    case INSIDE_EXHAUST:
    case INSIDE_TURBINE:
        add_film(load, area_m2 * (film + (running - film) * engine), engine > 0 ? gas_k : air_k);
        break;
    case INSIDE_MOTOR:
        add_film(load, area_m2 * running * (double)d->motor, 2500);
        break;
    case INSIDE_BODY:
        add_film(load, area_m2 * film * alive, 310);
        break;
    case INSIDE_ROOM:
        add_film(load, area_m2 * film * alive, 293);
        break;
    case INSIDE_FLUE:
        add_film(load, area_m2 * film * alive, 400);
        break;
    case INSIDE_GRAIN:
        add_film(load, area_m2 * film * (double)d->flare, 1900);
        break;
    case INSIDE_FIRE:
        add_film(load, area_m2 * film * (double)d->burning, 1100);
        break;
    case INSIDE_EMBER:
        add_film(load, area_m2 * film * (double)d->burning, 850);
        break;
    case INSIDE_SMOULDER:
        add_film(load, area_m2 * film * (double)d->burning, 400);
        break;
    default:
        break;
    }
}

/* What burns by itself: no fire heats it from within. */
static bool is_fire(PartInside inside)
{
    return inside == INSIDE_FIRE || inside == INSIDE_EMBER || inside == INSIDE_SMOULDER;
}

/* Shares of a patch's hemisphere. own: of its partners', the part that is left; near: all that its neighbours take. */
typedef struct Hemisphere {
    double sky, ground, under, own, near;
} Hemisphere;

/* The share that so many rays take, but not more than there is. */
static void take(double *share, double *taken, int rays)
{
    static const double each = 1.0 / (patch_points * patch_near_rays);
    const double        away = fmin(*share, rays * each);
    *share -= away, *taken += away;
}

static Hemisphere left_of(const PatchView *view, const NearView *near)
{
    Hemisphere h = {(double)view->sky, (double)view->ground, (double)view->under, 1, 0};
    double     own = 0;
    if (!near || near->partners == 0) return h;
    for (int k = 0; k < view->partners; k++) own += (double)view->share[k];
    take(&h.sky, &h.near, near->sky);
    take(&h.ground, &h.near, near->ground);
    take(&h.under, &h.near, near->under);
    double left = own;
    take(&left, &h.near, near->own);
    if (own > 0) h.own = left / own;
    return h;
}

/* Share of a patch that is below the water's surface. */
static double wet_share(const VehicleMoment *m, const Patch *patch)
{
    const NodePose *node = &m->pose.node[patch->node];
    const double   *up = m->pose.r_enu_from_body + 6;
    int             wet = 0;
    for (int k = 0; k < patch_points; k++) {
        double p_body[3];
        m3_mul_v3(p_body, node->r_body_from_node, patch->point_node[k]);
        v3_add(p_body, p_body, node->p_body);
        wet += v3_dot(up, p_body) < -m->place.above_m;
    }
    return (double)wet / patch_points;
}

static bool is_afloat(const VehicleMoment *m)
{
    const DisEntityType *type = &m->entity->type;
    enum { platform = 1, land = 1, surface = 3, subsurface = 4 }; /* of DIS */
    if (type->kind != platform) return false;
    return type->domain == surface || type->domain == subsurface || (type->domain == land && m->place.water);
}

static double water_film_w_m2k(double speed_mps) { return 200 + 1500 * pow(speed_mps, 0.8); }

/* Heat that the ground under a track or wheel takes, W/K. */
static double ground_w_k(const SkinNode *skin, const VehicleMoment *m, const EntityDrives *d)
{
    static const double near_m = 0.5, longest_s = 3600;
    static const double soil = 1000;      /* J/(m2 K s^1/2): 620 dry, 1400 moist; estimate */
    static const double gaps_w_m2k = 200; /* 0.13 mm of air and grit between; estimate */
    if (d->flying > 0 || !(fabs(m->place.above_m) < near_m) || !(skin->rolls_m2 > 0)) return 0;
    const bool   moves = (double)d->speed_mps > moving_mps;
    const double t_s = moves ? fmin(skin->print_m / (double)d->speed_mps, longest_s) : longest_s;
    const double bodies = 2 * skin->effusivity * soil / (skin->effusivity + soil) / sqrt(pi_rad * t_s);
    return (moves ? skin->rolls_m2 : skin->ground_m2) / (1 / bodies + 1 / gaps_w_m2k);
}

static void load_patch(NetworkLoad *load, const VehicleMoment *m, const PatchView *view, const double *temp_k, int i,
                       const EntityDrives *d)
{
    const Patch     *patch = &m->shape->patches->patch[i];
    const SkinNode  *skin = &m->shape->skin[i];
    const PlaceHeat *p = &m->place;
    const double     area = skin->area_m2, e = skin->emissivity, speed_mps = air_speed(m, patch, d);
    const double     wet = m->afloat ? wet_share(m, patch) : 0, open = (1 - wet) * skin->open_m2;
    const Hemisphere left = left_of(view, m->near ? &m->near[i] : NULL);
    NetworkLoad     *at = &load[skin->surface];

    const double level_w_m2 = p->direct_w_m2 * fmax(p->sun_d_enu[2], 0) + p->diffuse_w_m2;
    const double sun_w_m2 = p->direct_w_m2 * (double)m->lit[i] + p->diffuse_w_m2 * left.sky +
                            p->ground_rho * level_w_m2 * left.ground +
                            (m->near ? left.near * (double)m->near_sun_w_m2[i] : 0);
    double around_w_m2 = p->longwave_w_m2 * left.sky + stefan_w_m2k4 * pow(p->ground_k, 4) * left.ground +
                         stefan_w_m2k4 * pow(p->under_k, 4) * left.under;
    for (int k = 0; k < view->partners; k++) {
        const double other_k = temp_k[m->shape->skin[view->partner[k]].surface];
        around_w_m2 += left.own * (double)view->share[k] * stefan_w_m2k4 * pow(other_k, 4);
    }
    if (m->near) around_w_m2 += left.near * (double)m->near_w_m2[i];
    m->sent_w_m2[i] = (float)((1 - skin->absorptance) * sun_w_m2);
    const double flame = is_fire(skin->row.inside) ? 0 : flame_w_m2 * (double)d->burning;
    at->heat_w += open * (skin->absorptance * sun_w_m2 + e * around_w_m2 + flame);
    at->emits_m2 = e * open;
    add_film(at, open * film_at(fmax(speed_mps, (double)m->gas_mps[i]), p->air_density),
             p->air_k + vehicle_recovery_k(speed_mps) + (double)m->gas_k[i]);
    add_film(at, wet * skin->open_m2 * water_film_w_m2k((double)d->speed_mps), p->water_k);
    if (!m->afloat) add_film(at, ground_w_k(skin, m, d), (double)d->speed_mps > moving_mps ? p->ground_k : p->under_k);
    if (skin->row.drive == PART_DRIVE_MOTION && !(d->flying > 0)) {
        const double w = area * skin->friction * skin->row.drive_value * clamp((double)d->speed_mps / 10, 0, 2);
        at->heat_w += 0.5 * w;
        load[skin->inner].heat_w += 0.5 * w;
    }
    /* a grain or fire burns at its surface, and that of a heap is its crust */
    const bool outside = skin->row.inside == INSIDE_GRAIN || is_fire(skin->row.inside);
    add_inside(&load[outside ? skin->surface : skin->inner], &skin->row, &m->shape->machine, d, area, p->air_k);
}

static void add_gas(VehicleMoment *m, const JetPath *path)
{
    for (int i = 0; i < m->shape->patches->count; i++) {
        float gas_k, gas_mps;
        vehicle_view_gas(&gas_k, &gas_mps, &m->pose, i, path);
        if (gas_k > m->gas_k[i]) m->gas_k[i] = gas_k, m->gas_mps[i] = gas_mps;
    }
}

/* Exhaust past its patches: the warmest of its own and of its neighbours'. */
static void find_gas(VehicleMoment *m, const EntityDrives *d)
{
    const size_t octets = (size_t)m->shape->patches->count * sizeof *m->gas_k;
    JetPath      path;
    memset(m->gas_k, 0, octets);
    memset(m->gas_mps, 0, octets);
    if (m->entity->exhaust && d->engine > 0) {
        static const double origin[3] = {0, 0, 0};
        vehicle_jet(&path, m->entity->exhaust, origin, m->pose.r_enu_from_body, m->v_enu_mps, &m->place);
        add_gas(m, &path);
    }
    for (int n = 0; n < m->jets; n++) add_gas(m, m->jet[n]);
}

void vehicle_jet(JetPath *out, const ExhaustJet *exhaust, const double p_enu[3], const double r_enu_from_body[9],
                 const double v_enu_mps[3], const PlaceHeat *place)
{
    double at_enu[3], d_enu[3], flow[3];
    m3_mul_v3(at_enu, r_enu_from_body, exhaust->at_body);
    m3_mul_v3(d_enu, r_enu_from_body, exhaust->d_body);
    v3_add(at_enu, at_enu, p_enu);
    v3_sub(flow, place->wind_enu_mps, v_enu_mps);
    jet_path(out, exhaust, at_enu, d_enu, flow, place->air_k);
}

void vehicle_loads(NetworkLoad *load, VehicleMoment *m, const PatchView *view, const double *temp_k,
                   const EntityDrives *d)
{
    const VehicleShape *shape = m->shape;
    const MachineRow   *machine = &shape->machine;
    find_gas(m, d);
    m->afloat = is_afloat(m);
    for (int n = 0; n < shape->nodes; n++) load[n] = (NetworkLoad){.fluid_k = m->place.air_k};
    for (int i = 0; i < shape->patches->count; i++) load_patch(load, m, &view[i], temp_k, i, d);
    if (shape->engine >= 0) { /* the thermostat's radiator takes what the engine gives at its temperature */
        const double w = machine->engine_w * (double)d->engine, over_k = fmax(machine->engine_k - m->place.air_k, 5);
        load[shape->engine].heat_w += w;
        add_film(&load[shape->engine], w / over_k + machine->engine_j_k / leak_s, m->place.air_k);
    }
    if (shape->cabin >= 0) {
        load[shape->cabin].heat_w += d->engine > 0 ? machine->cabin_w : 0;
        add_film(&load[shape->cabin], machine->cabin_j_k / leak_s, m->place.air_k);
    }
}

void vehicle_links(const VehicleShape *shape, const EntityDrives *d)
{
    for (int k = 0; k < shape->links; k++) shape->conductance_w_k[k] = shape->link[k].conductance_w_k;
    for (int i = 0; i < shape->patches->count; i++) {
        const SkinNode *skin = &shape->skin[i];
        if (skin->inside_link < 0) continue;
        const double w_m2k =
            skin->row.inside_w_m2k + (skin->row.running_w_m2k - skin->row.inside_w_m2k) * (double)d->engine;
        shape->conductance_w_k[skin->inside_link] = w_m2k * skin->area_m2;
    }
    if (shape->fuel_link >= 0) shape->conductance_w_k[shape->fuel_link] = shape->machine.fuel_w_k * (double)d->engine;
    heat_network_conductances(shape->network, shape->conductance_w_k);
}
