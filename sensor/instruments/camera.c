/* sensor/instruments/camera.c: the camera of sensor.*: what it needs of the picture, and its noise in each frame. */
#include "sensor/instruments/camera.h"

#include <stdlib.h>

typedef struct CameraInstrument {
    Instrument    instrument;
    const Config *config;
    Camera        camera;
    bool          sensor; /* some band has one */
} CameraInstrument;

static Status open_camera(Instruments *list, const InstrumentsOf *of)
{
    CameraInstrument *c = calloc(1, sizeof *c);
    if (!c) return STATUS_NO_MEMORY;
    c->instrument = (Instrument){&camera_kind, camera_kind.name};
    c->config = of->config;
    for (int b = 0; b < BAND_COUNT; b++) c->sensor |= of->sensors->has[b];
    Status status = camera_open(&c->camera, of->sensors, of->config, true);
    if (status == STATUS_OK) status = camera_observe(&c->camera, of->sensors, of->config);
    const Status added = instruments_add(list, &c->instrument);
    return status == STATUS_OK ? added : status;
}

/* The image motion that a detector blurs by is known from the truth plane of ranges. */
static void request(RenderRequest *request, const Instrument *instrument, unsigned wants)
{
    if (!((const CameraInstrument *)instrument)->sensor) return;
    request->hand_over_cells |= (wants & WANT_CELLS) != 0;
    request->truth |= (wants & (WANT_DISPLAY | WANT_COUNTS)) != 0;
}

static Status look_through(FrameOutput *out, Instrument *instrument, const InstrumentLook *look)
{
    CameraInstrument *c = (CameraInstrument *)instrument;
    Frame            *f = look->frame;
    if (!(look->wants & WANT_TARGETS)) return STATUS_OK;
    TruthNoise *noise = arena_alloc(f->arena, 1, sizeof *noise);
    if (!noise) return STATUS_NO_MEMORY;
    camera_expose(noise, &c->camera, &f->seen.picture, c->config);
    out->record = noise;
    return STATUS_OK;
}

static void close_camera(Instrument *instrument)
{
    camera_close(&((CameraInstrument *)instrument)->camera);
    free(instrument);
}

const InstrumentKind camera_kind = {.name = "camera",
                                    .carries = "levels of its displays, lines of AC coupling",
                                    .open = open_camera,
                                    .request = request,
                                    .look = look_through,
                                    .close = close_camera};

const Camera *camera_of(const Instruments *list)
{
    const Instrument *found = instruments_find(list, &camera_kind);
    return found ? &((const CameraInstrument *)found)->camera : NULL;
}

const TruthNoise *camera_noise(const Frame *frame)
{
    const FrameOutput *out = frame_output(frame, &camera_kind);
    return out ? out->record : NULL;
}
