/* tests/scenes/faces_box.c: a painted box over flat ground. */
#include "tests/scenes/faces_box.h"

#include "render/air/air_private.h"

static const double sun_turn_rad = 2.2;                           /* of the sun's azimuth, clockwise from north */
static const double face_turn_rad = 25 * 0.017453292519943295769; /* of a lit face's normal from it */

/* Paint on the box, as it is or without its gloss; ground of one class, diffuse. The mean of the land, which lights
 * from farther off, stays. */
static void make_surfaces(FacesBox *box, const char *ground, bool glossy)
{
    Materials *m = &box->w.world.materials;
    Material   paint = m->material[materials_find(m, "paint_olive_flat")];
    Material   soil = m->material[materials_find(m, ground)];
    soil.gloss = 0;
    if (!glossy) paint.gloss = 0;
    for (int k = 0; k < m->count; k++) m->material[k] = paint;
    for (int k = 0; k < SURFACE_COUNT; k++) m->material[m->surface[k]] = soil;
    for (int c = 0; c < faces_channels; c++) {
        box->ground_rho[c] = (double)soil.rho[faces_channel[c]];
        box->box_rho[c] = (double)paint.rho[faces_channel[c]];
    }
    box->box_gloss[0] = (double)paint.gloss, box->box_gloss[1] = (double)paint.roughness;
}

static void put_box(FacesBox *box)
{
    const double c = cos(box->heading), s = sin(box->heading);
    const double r_enu_from_body[9] = {s, c, 0, c, -s, 0, 0, 0, -1}, middle_body[3] = {0, -1, -0.75};
    double       p_enu[3];
    m3_mul_v3(p_enu, r_enu_from_body, middle_body);
    p_enu[2] += box->ground_m + box->lift_m;
    stress_add(&box->w, p_enu, r_enu_from_body);
}

static Status light_box(FacesBox *box, const FacesKind *kind)
{
    const double    dark[AIR_BAND_COUNT] = {0}, sun_rad = kind->sun_rad;
    StressWorld    *w = &box->w;
    const AirSource source = world_air_source(&w->world, 0);
    Weather         weather = weather_default();
    const Sun       sun = {.elevation_rad = sun_rad,
                           .distance_au = 1,
                           .d_enu = {cos(sun_rad) * sin(sun_turn_rad), cos(sun_rad) * cos(sun_turn_rad), sin(sun_rad)}};
    weather.visibility_m = kind->visibility_m;
    weather.air_temp_k = NAN;
    air_even(&w->air, sun.d_enu, 0, dark, 0, w->world.planck_mwir, w->world.planck_lwir);
    const Status status =
        daylight_by_direction(&box->light, &source, &weather, &sun, (1u << AIR_BAND_COUNT) - 1, w->pool, w->air_arena);
    w->air.light = box->light;
    return status;
}

Status faces_box_open(FacesBox *out, const FacesKind *kind, int threads)
{
    memset(out, 0, sizeof *out);
    StressWorld *w = &out->w;
    Status       status = stress_world_open(w, threads);
    if (status != STATUS_OK) return status;
    atmosphere_close(w->world.atmosphere);
    w->world.atmosphere = NULL;
    if ((status = atmosphere_open(&w->world.atmosphere, kind->model)) != STATUS_OK) return status;
    if (materials_find(&w->world.materials, kind->ground) < 0) return STATUS_BAD_VALUE;
    w->world.landscape = &w->landscape;
    detail_table_close(w->world.detail);
    w->world.detail = NULL;
    make_surfaces(out, kind->ground, kind->glossy);
    out->heading = sun_turn_rad + face_turn_rad;
    out->lift_m = kind->lift_m;
    out->ground_m = elevation_height(&w->landscape.elevation, 0, 0, NULL);
    put_box(out);
    for (int v = 0; v < 2; v++) {
        const double turn = sun_turn_rad - 20 * rad_per_deg + v * pi_rad;
        const double eye[3] = {14 * sin(turn), 14 * cos(turn), out->ground_m + 6},
                     d[3] = {-eye[0], -eye[1], 0.7 + out->lift_m - 6};
        out->view[v] = stress_view(eye, d, 0, faces_width, faces_height, 340);
    }
    return light_box(out, kind);
}

void faces_box_close(FacesBox *box) { stress_world_close(&box->w); }

bool faces_box_see(FacesBox *box, int view, bool infrared, int samples)
{
    const RenderRequest request = {.view = box->view[view],
                                   .bands = 1 << BAND_OPTICAL,
                                   .truth = true,
                                   .optical = infrared ? OPTICAL_NIR : OPTICAL_RGB,
                                   .samples = 1,
                                   .sky_samples = samples,
                                   .sky_visibility = true,
                                   .hidden_entity = -1};
    return stress_render(&box->w, &request);
}
