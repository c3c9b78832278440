/* render/heat/wall_column.c: a wall or roof of one construction under the weather (wall_column_private.h). */
#include "render/heat/wall_column_private.h"

Status wall_kind(WallKind *out, const Construction *of, const Material *material)
{
    *out = (WallKind){.of = *of, .emissivity = 1 - (double)material->rho_lwir};
    out->absorptance = isnan(of->absorptance) ? (double)material->solar_absorptance : of->absorptance;
    const Status status = column_create(&out->column, of->layer, of->layers, wall_first_m, wall_growth);
    if (status == STATUS_OK && of->inside != BEHIND_BACK && of->inside != BEHIND_NONE)
        out->column.conductance_w_m2k[out->column.nodes - 1] = of->inside_w_m2k;
    return status;
}

/* ---- outside ----------------------------------------------------------------------------------- */

/* Film of glass in the wind alone, W/(m2 K). */
static double forced_w_m2k(const SurfaceAir *air)
{
    static const double eaves_m = 3, hedges_m = 0.1;
    const double        mps = air->wind_mps * log(eaves_m / hedges_m) / log(air->wind_height_m / hedges_m);
    return 0.5 * (3.26 * pow(mps, 0.89) + 3.55 * pow(mps, 0.617));
}

/* Of still air. up: of the normal. */
static double natural_w_m2k(double over_k, double up)
{
    const double root = cbrt(fabs(over_k));
    return (over_k > 0) == (up > 0) ? 9.482 * root / (7.238 - fabs(up)) : 1.810 * root / (1.382 + fabs(up));
}

double wall_film_w_m2k(const WallFlux *law, double temp_k, double up)
{
    const double natural = natural_w_m2k(temp_k - law->air_k, up), forced = law->forced_w_m2k;
    return natural + law->rough * (sqrt(natural * natural + forced * forced) - natural);
}

/* What a side absorbs, W/m2. */
static double absorbed_w_m2(const WallKind *k, const WallPlace *p, const double n_enu[3], double sun)
{
    const GroundWeather *w = p->weather;
    const double         sky = 0.5 * (1 + n_enu[2]), high = sqrt(sky), air_k = w->air.temp_k;
    const double         level = w->direct_w_m2 * fmax(w->sun_d_enu[2], 0) + w->diffuse_w_m2;
    const double         light = sun * w->direct_w_m2 * fmax(v3_dot(n_enu, w->sun_d_enu), 0) + sky * w->diffuse_w_m2 +
                         (1 - sky) * p->ground_rho * level;
    return k->absorptance * light +
           k->emissivity * (sky * (high * w->longwave_w_m2 + (1 - high) * stefan_w_m2k4 * pow(air_k, 4)) +
                            (1 - sky) * stefan_w_m2k4 * pow(p->ground_k, 4));
}

void wall_flux(WallFlux *out, const WallKind *k, const WallPlace *p, const WallFace *face)
{
    const double back[3] = {-face->n_enu[0], -face->n_enu[1], -face->n_enu[2]};
    *out = (WallFlux){.sides = k->of.inside == BEHIND_BACK ? 2 : 1,
                      .air_k = p->weather->air.temp_k,
                      .absorbed_w_m2 = absorbed_w_m2(k, p, face->n_enu, face->sun),
                      .emissivity = k->emissivity,
                      .forced_w_m2k = forced_w_m2k(&p->weather->air),
                      .rough = k->of.rough,
                      .up = face->n_enu[2]};
    if (out->sides == 2) out->absorbed_w_m2 += absorbed_w_m2(k, p, back, face->sun);
}

double wall_flux_w_m2(double *falls, double temp_k, const void *law)
{
    const WallFlux *l = law;
    const double    t2 = temp_k * temp_k, emits = l->sides * l->emissivity * stefan_w_m2k4;
    double          film = wall_film_w_m2k(l, temp_k, l->up);
    if (l->sides == 2) film += wall_film_w_m2k(l, temp_k, -l->up);
    *falls = 4 * emits * t2 * temp_k + film;
    return l->absorbed_w_m2 - emits * t2 * t2 - film * (temp_k - l->air_k);
}

typedef struct Between {
    WallFlux from, to;
} Between;

/* Straight between the two. */
static void law_between(void *law, double share, const void *user)
{
    const Between *b = user;
    WallFlux      *out = law;
    _Static_assert(sizeof *out <= column_law_octets, "room for the law");
    *out = b->from;
    out->air_k += share * (b->to.air_k - b->from.air_k);
    out->absorbed_w_m2 += share * (b->to.absorbed_w_m2 - b->from.absorbed_w_m2);
    out->forced_w_m2k += share * (b->to.forced_w_m2k - b->from.forced_w_m2k);
}

/* ---- behind ------------------------------------------------------------------------------------ */

static const double wall_day_s = 86400;

double wall_behind_k(const Construction *of, double hour, double day_k, double air_k, double room_k)
{
    static const double wakes_h = 6, sleeps_h = 22, gains_k = 3, heating_k = 288.15;
    const double        set_k = hour >= wakes_h && hour < sleeps_h ? of->room_day_k : of->room_night_k;
    return of->inside == BEHIND_HEATED     ? fmax(set_k, day_k + gains_k)
           : of->inside == BEHIND_UNHEATED ? room_k
           : of->inside == BEHIND_FLUE     ? (day_k < heating_k ? set_k : air_k)
                                           : air_k;
}

double wall_room_step(const Construction *of, double room_k, double faces_k, double air_k, double dt_s)
{
    const double stored = of->room_j_m2k / dt_s, film = of->inside_w_m2k, change = of->room_w_m2k;
    return (stored * room_k + film * faces_k + change * air_k) / (stored + film + change);
}

double wall_day_step(double day_k, double air_k, double dt_s)
{
    return air_k + (day_k - air_k) * exp(-dt_s / wall_day_s);
}

/* ---- steps ------------------------------------------------------------------------------------- */

void wall_step(ColumnState *state, const WallKind *k, const ColumnFactors *factors, const WallPlace *before,
               const WallPlace *after, const WallFace *face, double behind_k, double tolerance_k, double dt_s)
{
    Between b;
    wall_flux(&b.from, k, before, face);
    wall_flux(&b.to, k, after, face);
    const ColumnBoundary boundary = {wall_flux_w_m2, law_between, &b, behind_k, tolerance_k};
    column_step(state, &k->column, factors, &boundary, dt_s);
}

double wall_conductance_w_m2k(const WallKind *k)
{
    const Column *c = &k->column;
    double        m2k_w = 0;
    for (int i = 0; i < c->nodes; i++) {
        if (!(c->conductance_w_m2k[i] > 0)) return 0;
        m2k_w += 1 / c->conductance_w_m2k[i];
    }
    return 1 / m2k_w;
}

void wall_start(ColumnState *out, const WallKind *k, double outer_k, double behind_k)
{
    const double flow_w_m2 = wall_conductance_w_m2k(k) * (outer_k - behind_k);
    column_start(out, &k->column, outer_k);
    for (int i = 1; i < k->column.nodes; i++)
        out->temp_k[i] = out->temp_k[i - 1] - flow_w_m2 / k->column.conductance_w_m2k[i - 1];
}
