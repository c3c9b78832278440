/* sensor/instruments/radar.c: the radar of radar.*: opened as the settings say, and aimed as the eye is. */
#include "sensor/instruments/radar.h"

#include "sensor/frame/frame_world.h"
#include "sensor/frame/radar_record.h"

#include <stdlib.h>

typedef struct RadarInstrument {
    Instrument    instrument;
    const Config *config;
    SeekerRadar  *radar;
} RadarInstrument;

Status radar_open(SeekerRadar **out, const Config *config, const char *isa, bool live, Cache *cache)
{
    char catalog[4096];
    if (!etc_path(catalog, sizeof catalog, "catalog.csv")) return STATUS_BAD_VALUE;
    return seeker_radar_create(out, &(SeekerRadarConfig){.preset = config->radar.preset,
                                                         .table = config->radar.table,
                                                         .catalog = catalog,
                                                         .isa = isa,
                                                         .ground = config->radar.ground,
                                                         .ground_bounce = config->radar.ground_bounce,
                                                         .scenery = config->radar.scenery,
                                                         .warp_m = 1e-3 * config->radar.warp_mm,
                                                         .given = config->radar.given,
                                                         .wind_mps = config->weather.wind_mps,
                                                         .chaff_dipoles = config->radar.chaff_dipoles,
                                                         .scan_rad = config->radar.scan_deg * rad_per_deg,
                                                         .scan_step = config->radar.scan_step,
                                                         .seed = (uint64_t)config->seed,
                                                         .library = config->radar.library,
                                                         .cache = cache,
                                                         .background = live});
}

static Status open_radar(Instruments *list, const InstrumentsOf *of)
{
    if (strcmp(of->config->radar.preset, "none") == 0) return STATUS_OK;
    RadarInstrument *r = calloc(1, sizeof *r);
    if (!r) return STATUS_NO_MEMORY;
    r->instrument = (Instrument){&radar_kind, radar_kind.name};
    r->config = of->config;
    const Status status = radar_open(&r->radar, of->config, of->isa, of->live, of->cache);
    const Status added = instruments_add(list, &r->instrument);
    return status == STATUS_OK ? added : status;
}

/* Files of a scan show what each pixel does. */
static void request(RenderRequest *request, const Instrument *instrument, unsigned wants)
{
    const Config *config = ((const RadarInstrument *)instrument)->config;
    (void)wants;
    request->truth |= config->radar.scan_deg > 0 && config->publish.files;
}

static Status measure(FrameOutput *out, Instrument *instrument, const InstrumentLook *look)
{
    const RadarInstrument *r = (const RadarInstrument *)instrument;
    Frame                 *f = look->frame;
    const LocalFrame      *frame = &f->world->frame;
    const Weather          weather = frame_weather_at(r->config, f->world, f->unix_s);
    const RadarFrame      *measured = NULL;
    RadarScene             scene = {.world = f->world,
                                    .refraction = f->request.refraction,
                                    .snapshot = &f->seen.snapshot,
                                    .view = &f->request.view,
                                    .hidden = f->request.hidden_entity,
                                    .skips_off = f->request.skips_off,
                                    .reference_m = look->aim_m,
                                    .t_s = f->time_s,
                                    .weather = &weather,
                                    .number = (uint32_t)f->number,
                                    .coarse = look->noted == INSTRUMENT_COARSE,
                                    .range_m = f->seen.picture.range_m,
                                    .entity = f->seen.picture.entity};
    m3_tmul_v3(scene.v_enu_mps, frame->r_ecef_from_enu, look->eye->v_ecef_mps);
    if (look->aim >= 0)
        m3_tmul_v3(scene.reference_v_enu_mps, frame->r_ecef_from_enu, f->seen.snapshot.entity[look->aim].v_ecef_mps);
    const Status status = seeker_radar_measure(&measured, r->radar, &scene, look->pool, f->arena);
    if (status != STATUS_OK) return status;
    if (!measured) {
        out->left_out = "signatures of targets were still to be made; radar.library keeps them for the next run "
                        "(`pitviper rcs MODEL --library` makes them)";
        return STATUS_OK;
    }
    out->coarse = measured->coarse;
    FrameArray *array = arena_alloc(f->arena, radar_arrays_most, sizeof *array);
    if (!array) return STATUS_NO_MEMORY;
    out->array = array;
    out->arrays = radar_arrays(array, measured);
    out->record = f->record.radar = measured;
    if ((look->wants & (WANT_ERROR | WANT_TARGETS)) != (WANT_ERROR | WANT_TARGETS) || !f->request.budget)
        return STATUS_OK;
    RadarError *error = arena_alloc(f->arena, 1, sizeof *error);
    if (!error) return STATUS_NO_MEMORY;
    radar_error(error, measured, &f->seen.snapshot);
    f->record.radar_error = error;
    return STATUS_OK;
}

static void close_radar(Instrument *instrument)
{
    seeker_radar_destroy(((RadarInstrument *)instrument)->radar);
    free(instrument);
}

static Status prepare(Instrument *instrument, const Catalog *catalog, const Snapshot *snapshot)
{
    return seeker_radar_prepare(((RadarInstrument *)instrument)->radar, catalog, snapshot);
}

static InstrumentReady ready(const Instrument *instrument)
{
    const RadarPrepared prepared = seeker_radar_prepared(((const RadarInstrument *)instrument)->radar);
    return (InstrumentReady){prepared.made, prepared.waiting};
}

const InstrumentKind radar_kind = {.name = "radar",
                                   .noted = "signatures of targets were still to be made when it was recorded",
                                   .open = open_radar,
                                   .request = request,
                                   .look = measure,
                                   .close = close_radar,
                                   .prepare = prepare,
                                   .ready = ready};

const RadarFrame *radar_of(const Frame *frame)
{
    const FrameOutput *out = frame_output(frame, &radar_kind);
    return out ? out->record : NULL;
}
