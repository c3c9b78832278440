/* render/probe.c: `pitviper probe` for this folder: Planck, ray intersection, atmosphere, heat and radar clutter for
 * rows of CSV. */
#include "render/probe.h"

#include "entities/import/model_import.h"
#include "render/air/atmosphere.h"
#include "render/trace/parts/parts.h"
#include "render/materials/planck.h"
#include "render/probe_private.h"
#include "terrain/probe.h"

#include <stdlib.h>

static const char *planck_row(void *state, const ProbeValue *in, ProbeValue *out)
{
    (void)state;
    const double low_m = in[0].number * 1e-6, high_m = in[1].number * 1e-6, temp_k = in[2].number;
    if (!(low_m > 0 && high_m > low_m)) return "lo_um must be above 0 and below hi_um";
    if (!(temp_k > 0)) return "temp_k must be above 0";
    out[0].number = planck_band(low_m, high_m, temp_k, &out[1].number);
    return NULL;
}

/* ---- rays: one model, its joints at 0 ------------------------------------------------ */

typedef struct RayProbe {
    Model       model;
    Tracer     *tracer;
    PosedEntity entity;
    double      scale_m, r_body_from_file[9], p_origin_file[3]; /* of the rows' axes */
} RayProbe;

static void rays_close(void *state)
{
    RayProbe *p = state;
    tracer_destroy(p->tracer);
    free(p->entity.node);
    model_destroy(&p->model);
    free(p);
}

/* rays MODEL [file|body]: in a file's own axes, origin and units unless a sidecar defines them. */
static Status rays_open(void **state, int argc, char **argv)
{
    static const double origin[3] = {0, 0, 0};
    double              attitude[9];
    ModelImport         report = {0};
    bool                imported = false;
    if (argc < 2 || argc > 3 || (argc == 3 && strcmp(argv[2], "file") != 0 && strcmp(argv[2], "body") != 0)) {
        log_error("rays: usage: probe rays MODEL [file|body]: a built-in name or a file; and the axes of the rows "
                  "in");
        return STATUS_BAD_VALUE;
    }
    RayProbe *p = calloc(1, sizeof *p);
    if (!p) return STATUS_NO_MEMORY;
    Status status = model_open(&p->model, &report, &imported, argv[1], 0.002);
    p->scale_m = 1;
    m3_identity(p->r_body_from_file);
    const bool file_axes = argc == 3 ? strcmp(argv[2], "file") == 0 : imported && !report.sidecar[0];
    if (status == STATUS_OK && file_axes && imported) {
        p->scale_m = report.scale_m;
        memcpy(p->r_body_from_file, report.r_body_from_file, sizeof p->r_body_from_file);
        memcpy(p->p_origin_file, report.p_origin_file, sizeof p->p_origin_file);
    }
    const Model *model = &p->model;
    if (status == STATUS_OK) status = tracer_create_models(&p->tracer, &model, 1, "avx2");
    NodePose *pose = status == STATUS_OK ? calloc((size_t)model->node_count, sizeof *pose) : NULL;
    if (status == STATUS_OK)
        p->entity.node = calloc((size_t)parts_node_count(p->tracer, 0) + 1, sizeof *p->entity.node);
    if (status == STATUS_OK && (!pose || !p->entity.node)) status = STATUS_NO_MEMORY;
    if (status == STATUS_OK) {
        model_pose(pose, model, NULL);
        m3_identity(attitude);
        parts_pose(&p->entity, p->tracer, 0, pose, origin, attitude, 0);
        *state = p;
    } else {
        rays_close(p);
    }
    free(pose);
    return status;
}

static const char *rays_row(void *state, const ProbeValue *in, ProbeValue *out)
{
    const RayProbe *p = state;
    double          o_file[3], o[3], d_file[3], d[3], n_geo[3], n[3], n_file[3];
    PartHit         hit;
    for (int i = 0; i < 3; i++) {
        o_file[i] = in[i].number - p->p_origin_file[i];
        d_file[i] = in[3 + i].number;
    }
    m3_mul_v3(o, p->r_body_from_file, o_file);
    v3_scale(o, p->scale_m, o);
    m3_mul_v3(d, p->r_body_from_file, d_file);
    if (!v3_normalize(d, d)) return "dx,dy,dz must not all be 0";
    const double range_m = parts_first_hit(&hit, &p->entity, o, d, INFINITY, false);
    out[0].number = !isinf(range_m);
    for (int i = 1; i < 5; i++) out[i].number = NAN;
    out[5].text = "";
    if (isinf(range_m)) return NULL;
    parts_normals(n_geo, n, &p->model, &p->entity, &hit, o, d, range_m);
    m3_tmul_v3(n_file, p->r_body_from_file, n_geo);
    out[1].number = range_m;
    for (int i = 0; i < 3; i++) out[2 + i].number = n_file[i];
    out[5].text = p->model.part[p->model.triangle_part[hit.triangle]].name;
    return NULL;
}

/* ---- atmosphere -------------------------------------------------------------------------------- */

enum { probe_models_max = 16 };

/* Models are opened when a row first names them and cached, for the standard channels and for each further one, whose
 * tables take a place among them; one that failed is cached as NULL. */
typedef struct AtmosphereProbe {
    int                    count;
    char                   name[probe_models_max][64];
    const SpectralChannel *further[probe_models_max]; /* NULL: the standard channels */
    Atmosphere            *model[probe_models_max];
    Arena                 *arena; /* of the air under a row's weather */
} AtmosphereProbe;

static Status atmosphere_probe_open(void **state, int argc, char **argv)
{
    (void)argc;
    (void)argv;
    AtmosphereProbe *probe = calloc(1, sizeof *probe);
    if (probe) probe->arena = arena_create();
    *state = probe;
    return probe && probe->arena ? STATUS_OK : STATUS_NO_MEMORY;
}

static void atmosphere_probe_close(void *state)
{
    AtmosphereProbe *probe = state;
    if (!probe) return;
    arena_destroy(probe->arena);
    for (int i = 0; i < probe->count; i++) atmosphere_close(probe->model[i]);
    free(probe);
}

static const char *find_model(const Atmosphere **out, AtmosphereProbe *probe, const char *name,
                              const SpectralChannel *further)
{
    int i = 0;
    while (i < probe->count && (strcmp(probe->name[i], name) != 0 || probe->further[i] != further)) i++;
    if (i == probe->count) {
        if (i == probe_models_max || strlen(name) >= sizeof probe->name[i]) return "too many models, or name too long";
        if (atmosphere_open(&probe->model[i], name) != STATUS_OK) probe->model[i] = NULL;
        snprintf(probe->name[i], sizeof probe->name[i], "%s", name);
        probe->further[i] = further;
        probe->count++;
    }
    *out = probe->model[i];
    return *out ? NULL : "no such model, or its tables are invalid (see the log)";
}

typedef struct RowAir {
    const Atmosphere *model;
    AirBand           band;
    double            visibility_m;
} RowAir;

/* The model's air under the weather of a row; without one the model's own. */
static const char *under_weather(const Atmosphere **out, AtmosphereProbe *probe, const RowAir *row,
                                 const ProbeValue *air_temp_k, const ProbeValue *humidity_pct)
{
    Weather weather = weather_default();
    *out = row->model;
    if (!isfinite(air_temp_k->number) && !isfinite(humidity_pct->number)) return NULL;
    if (!isfinite(humidity_pct->number)) return "air_temp_k needs humidity_pct beside it";
    weather.air_temp_k = isfinite(air_temp_k->number) ? air_temp_k->number : atmosphere_temp_k(row->model, 0);
    weather.humidity = 0.01 * humidity_pct->number;
    if (!(weather.air_temp_k >= 220 && weather.air_temp_k <= 330)) return "air_temp_k must be 220 .. 330";
    if (!(weather.humidity >= 0 && weather.humidity <= 1)) return "humidity_pct must be 0 .. 100";
    const AirState state = {row->visibility_m, weather.air_temp_k, weather_vapour_kg_m3(&weather)};
    arena_reset(probe->arena);
    return atmosphere_in(out, row->model, &state, ~0u, probe->arena) == STATUS_OK ? NULL : "out of memory";
}

/* Model, visibility_km and band, which begin a row. A further channel has its place until the next row. */
static const char *air_of_row(RowAir *out, AtmosphereProbe *probe, const ProbeValue *in)
{
    const SpectralChannel *channel = channel_named(in[2].text, strlen(in[2].text));
    if (!channel) return "band must be b, g, r, pan, nir, mwir, lwir or a further channel of etc/channels.csv";
    channels_standard();
    if (!channel->standard) channel_choose(channel);
    out->band = channel->place;
    out->visibility_m = in[1].number * 1e3;
    const char *why = find_model(&out->model, probe, in[0].text, channel->standard ? NULL : channel);
    if (why) return why;
    return out->visibility_m > 0 ? NULL : "visibility_km must be above 0";
}

static const char *atmosphere_row(void *state, const ProbeValue *in, ProbeValue *out)
{
    RowAir            row;
    const Atmosphere *here;
    const char       *why = air_of_row(&row, state, in);
    if (why) return why;
    const double  temp_k = in[6].number;
    const bool    sun = isfinite(in[7].number);
    const AirPath path = {in[3].number, in[4].number, in[5].number * 1e3, sun ? in[7].number * rad_per_deg : pi_rad,
                          isfinite(in[8].number) ? in[8].number * rad_per_deg : 0};
    if (!(path.observer_m >= 0 && path.target_m >= 0)) return "heights must be at or above the ground";
    /* a range rounded to print may fall short of a vertical path by its last digit */
    if (!(path.range_m > 0 && path.range_m >= 0.9999 * fabs(path.observer_m - path.target_m)))
        return "range_km must be above 0 and at least the difference of the heights";
    if (!(temp_k > 0)) return "temp_k must be above 0";
    why = under_weather(&here, state, &row, &in[9], &in[10]);
    if (why) return why;
    PathAir air;
    atmosphere_path(&air, here, row.visibility_m, row.band, &path, temp_k);
    out[0].number = air.transmittance;
    out[1].number = air.thermal_w_m2_sr;
    out[2].number = air.sun_transmittance;
    if (sun) out[3].number = air.scattered_w_m2_sr;
    return NULL;
}

static const char *sky_row(void *state, const ProbeValue *in, ProbeValue *out)
{
    RowAir            row;
    const Atmosphere *here;
    const char       *why = air_of_row(&row, state, in);
    if (why) return why;
    const double observer_m = in[3].number, zenith_rad = in[4].number * rad_per_deg;
    const bool   sun = isfinite(in[5].number);
    if (!(observer_m >= 0)) return "heights must be at or above the ground";
    if (!(in[4].number >= 0 && in[4].number <= 180)) return "zenith_deg must be 0 .. 180";
    why = under_weather(&here, state, &row, &in[7], &in[8]);
    if (why) return why;
    SkyAir sky;
    atmosphere_sky(&sky, here, row.visibility_m, row.band, observer_m, zenith_rad,
                   sun ? in[5].number * rad_per_deg : pi_rad, isfinite(in[6].number) ? in[6].number * rad_per_deg : 0);
    out[0].number = sky.thermal_w_m2_sr;
    if (sun) out[1].number = sky.scattered_w_m2_sr;
    return NULL;
}

static const char *sunlight_row(void *state, const ProbeValue *in, ProbeValue *out)
{
    RowAir            row;
    const Atmosphere *here;
    const char       *why = air_of_row(&row, state, in);
    if (why) return why;
    if (!(in[3].number >= 0)) return "heights must be at or above the ground";
    if (!(in[4].number >= 0 && in[4].number <= 90)) return "sun_zenith_deg must be 0 .. 90";
    why = under_weather(&here, state, &row, &in[5], &in[6]);
    if (why) return why;
    SunAir sun;
    atmosphere_sun(&sun, here, row.visibility_m, row.band, in[3].number, in[4].number * rad_per_deg);
    out[0].number = sun.direct_normal_w_m2;
    out[1].number = sun.diffuse_horizontal_w_m2;
    return NULL;
}

const Probe render_probes[] = {
    {.name = "planck",
     .help = "in-band radiance of a black body and its derivative in temperature",
     .in = "lo_um,hi_um,temp_k",
     .out = "radiance_w_m2_sr,dldt",
     .row = planck_row},
    {.name = "rays",
     .arguments = "MODEL [file|body]",
     .help = "first hit on a model, its joints at 0; in the file's own axes, origin and units (distances in m) if it "
             "has no "
             "sidecar, else in body axes",
     .in = "ox_m,oy_m,oz_m,dx,dy,dz",
     .out = "hit,dist_m,nx,ny,nz,part$",
     .open = rays_open,
     .row = rays_row,
     .close = rays_close},
    {.name = "atmosphere",
     .help =
         "transmittance and path radiance from the tables of etc/atmosphere; band: any channel of etc/channels.csv; "
         "temp_k: of the target; air_temp_k and humidity_pct: of the air at the ground, without them the model's own",
     .in = "model$,visibility_km,band$,observer_m,target_m,range_km,temp_k,sun_zenith_deg?,rel_azimuth_deg?,"
           "air_temp_k?,humidity_pct?",
     .out = "tau,path_radiance,sun_tau,scattered",
     .open = atmosphere_probe_open,
     .row = atmosphere_row,
     .close = atmosphere_probe_close},
    {.name = "sky",
     .help =
         "radiance of the sky from the same tables; zenith_deg beyond 90: below the horizontal, past the ray's lowest "
         "point (one that would meet the ground: past the ground there)",
     .in =
         "model$,visibility_km,band$,observer_m,zenith_deg,sun_zenith_deg?,rel_azimuth_deg?,air_temp_k?,humidity_pct?",
     .out = "radiance,scattered",
     .open = atmosphere_probe_open,
     .row = sky_row,
     .close = atmosphere_probe_close},
    {.name = "sunlight",
     .help = "light of the sun on a plane that faces it and of the sky on a level one, in a band, by the same tables, "
             "at 1 AU",
     .in = "model$,visibility_km,band$,observer_m,sun_zenith_deg,air_temp_k?,humidity_pct?",
     .out = "direct_w_m2,diffuse_w_m2",
     .open = atmosphere_probe_open,
     .row = sunlight_row,
     .close = atmosphere_probe_close},
    {.name = "heat-ground",
     .arguments = PROBE_WEATHER_ARGUMENTS,
     .help =
         "temperature of the ground, warmed up over the two days before each local day, and what it takes and gives; surface: "
         "of etc/ground_heat.csv; aspect: where the slope faces, clockwise from north; shade: share of the direct sun "
         "taken, all day; depth: of level ground in the open; weather as of `weather`",
     .in = "unix_s,surface$,slope_deg?,aspect_deg?,shade?,depth_m?",
     .out = "temp_k,air_temp_k,absorbed_w_m2,direct_w_m2,diffuse_w_m2,longwave_w_m2,film_w_m2k,latent_w_m2",
     .open = heat_probe_open,
     .row = heat_probe_row,
     .close = heat_probe_close},
    {.name = "heat-wall",
     .arguments = PROBE_WEATHER_ARGUMENTS,
     .help =
         "temperature of a wall or roof in the open, warmed up over the two days before each local day, and what it "
         "takes and gives; construction: of etc/constructions.csv; material: of etc/materials.csv; tilt: of its outer "
         "face, 0 a flat roof, 90 a wall (90); aspect: where it faces, clockwise from north (0); shade: share of the "
         "direct sun taken, all day (0); behind: of its room; ground: about it; weather as of `weather`",
     .in = "unix_s,construction$,material$,tilt_deg?,aspect_deg?,shade?",
     .out = "temp_k,behind_k,air_temp_k,ground_k,absorbed_w_m2,direct_w_m2,diffuse_w_m2,longwave_w_m2,film_w_m2k",
     .open = wall_probe_open,
     .row = wall_probe_row,
     .close = wall_probe_close},
    {.name = "heat-node",
     .arguments = PROBE_WEATHER_ARGUMENTS,
     .help =
         "temperature of a part of a vehicle on level grass, mean by area and range over its patches; each row is an "
         "entity that begins then: it stood a day with its engine stopped, and for the last hour did what the row says; "
         "part: as `model info` lists them, empty: all; heading: clockwise from north (270); engine: share of full power "
         "(0); weather as of `weather`",
     .in = "unix_s,model$,part$?,heading_deg?,engine?,speed_mps?",
     .out = "temp_k,low_k,high_k,air_k,ground_k",
     .open = heat_node_probe_open,
     .row = heat_node_probe_row,
     .close = heat_node_probe_close},
    {.name = "propagation",
     .arguments = "[MODEL]",
     .help =
         "what air, rain, fog and cloud take from a radio wave on a straight path, one way (ITU-R P.676-13, P.838-3, "
         "P.840-9), and its two-way factor; MODEL: of etc/atmosphere (us1976), for temperatures; heights above its "
         "ground; tilt: of the polarisation, 0 horizontal, 90 vertical, 45 circular too; visibility: fog from 1000 m "
         "down, below fog_top_m (empty: everywhere); the figures per km are those at from_m",
     .in = "frequency_ghz,from_m,to_m,range_m,air_temp_k?,pressure_mbar?,humidity?,rain_mm_h?,tilt_deg?,visibility_m?,"
           "fog_top_m?,cloud_low_m?,cloud_high_m?,cloud_g_m3?",
     .out = "gas_db,rain_db,cloud_db,two_way_db,amplitude,phase_rad,dry_db_km,wet_db_km,rain_db_km,cloud_db_km,"
            "rain_top_m,vapour_g_m3,fog_g_m3",
     .open = propagation_probe_open,
     .row = propagation_probe_row,
     .close = propagation_probe_close},
    {.name = "radar-equation",
     .help = "power of an echo, thermal noise at 290 K and their ratio; loss: both ways, of the system and of the "
             "air together",
     .in = "power_w,gain_db,frequency_ghz,rcs_dbsm,range_m,bandwidth_hz,noise_figure_db,loss_db?",
     .out = "received_dbw,noise_dbw,snr_db",
     .row = radar_equation_probe_row},
    {.name = "rcs",
     .help =
         "scattered field and radar cross section of a target by ray tubes, physical optics and edges, as received and transmitted "
         "polarisation; target: a built-in model, a file, or sphere:R, plate:AxB, disc:R, cylinder:RxL, dihedral:AxB, "
         "trihedral:A, corner:A in m, of metal; azimuth: clockwise from the nose; range: empty, far field; rx: the receiver's, "
         "empty: at the transmitter; joints at rest",
     .in = "target$,f_ghz,az_deg,el_deg,range_m?,rx_az_deg?,rx_el_deg?",
     .out = "hh_dbsm,hv_dbsm,vh_dbsm,vv_dbsm,hh_re_m,hh_im_m,hv_re_m,hv_im_m,vh_re_m,vh_im_m,vv_re_m,vv_im_m",
     .open = rcs_probe_open,
     .row = rcs_probe_row,
     .close = rcs_probe_close},
    {.name = "clutter",
     .help =
         "what ground sends back to a radar, by etc/radar/clutter.csv: backscatter by area, shape of the texture (0: "
         "Rayleigh), internal motion in wind (share of the power that is still, spread of the exponential spectrum, rms "
         "Doppler width of the moving part), loss of a path through foliage (1 m), one way, and its backscatter by volume",
     .in = "surface$,frequency_ghz,grazing_deg,wind_mps?,depth_m?",
     .out = "sigma0_vv_db,sigma0_hh_db,sigma0_hv_db,rho,nu,texture_m,still,spread_mps,width_hz,foliage_db,volume_1_m",
     .open = clutter_probe_open,
     .row = clutter_probe_row,
     .close = clutter_probe_close},
    {.name = "clutter-cell",
     .help =
         "scattering of one resolution cell of level ground, the square of side_m (1) that holds x, y, summed over its 16 "
         "scatterers about its middle, m; relative: intensity over its mean. A row a place for the distribution, a row a "
         "time or azimuth (of the antenna, clockwise from north) for the correlation",
     .in = "surface$,frequency_ghz,grazing_deg,x_m,y_m,side_m?,azimuth_deg?,wind_mps?,t_s?,seed?",
     .out = "vv_re,vv_im,hh_re,hh_im,hv_re,hv_im,relative",
     .open = clutter_probe_open,
     .row = clutter_cell_probe_row,
     .close = clutter_probe_close},
};
const int render_probe_count = sizeof render_probes / sizeof *render_probes;
