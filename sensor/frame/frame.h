/* sensor/frame/frame.h: a finished frame, as consumers receive it (sensor/publish/consumers/consumer.h).
 *
 * Immutable once finished, and reference-counted: a consumer that keeps one beyond its put holds it and releases it.
 * All that it points to is in its arena or outlives the run. A pool has a fixed number of frames, so memory is
 * bounded: taking one waits until one is free. */
#ifndef SENSOR_FRAME_FRAME_H
#define SENSOR_FRAME_FRAME_H

#include "render/frame/planes.h"
#include "sensor/frame/frame_display.h"
#include "sensor/frame/latency_private.h"
#include "sensor/frame/plane.h"
#include "sensor/frame/records.h"
#include "sensor/radar/radar_frame.h"

enum { frame_max_planes = planes_most, frame_max_axes = 4, frame_max_outputs = 8 };

/* What consumers may want of a frame. */
typedef enum FrameWant {
    WANT_PLANES = 1 << 0,    /* planes of truth; planes of the bands are always present */
    WANT_TARGETS = 1 << 1,   /* record.target */
    WANT_ERROR = 1 << 2,     /* record.error, where the error budget is on */
    WANT_CELLS = 1 << 3,     /* picture.small: small targets as a detector needs them */
    WANT_WITHOUT = 1 << 4,   /* a second rendering without the target, or without all entities */
    WANT_SHA256 = 1 << 5,    /* of all planes, truth too */
    WANT_DISPLAY = 1 << 6,   /* frame.display: behind the detector, with gain and level */
    WANT_COUNTS = 1 << 7,    /* frame.display.counts: raw counts of the bands with a sensor */
    WANT_FOOTPRINT = 1 << 8, /* record.footprint: where the boresight and the corners meet the ground */
    WANT_LATENCY = 1 << 9,   /* when other consumers are done with the frame: closed after those that do not want it */
} FrameWant;

/* A named array. The last axis is contiguous in memory. */
typedef struct FrameArray {
    const char *group; /* `lwir`, `radar`, `truth`: planes that go into one file */
    const char *name;  /* within the group: `Y`, `R`, `range_m`, `profile` */
    const char *unit;
    const char *model, *wavelengths_um; /* of radiance: its sensor, and its channels in the order of the group's
                                         * planes */
    PlaneKind   kind;
    PlaneType   type;
    int         axes;
    const char *axis[frame_max_axes]; /* `row`, `column`, `bin`, `bounce` */
    int         size[frame_max_axes];
    const void *values;
} FrameArray;

/* What an instrument hands out in a frame (sensor/instruments/instrument.h). */
typedef struct InstrumentKind InstrumentKind;
typedef struct FrameOutput {
    const char           *name; /* of the instrument: several of a kind have different ones */
    const InstrumentKind *kind;
    int                   arrays;
    const FrameArray     *array;  /* [arrays] */
    const void           *record; /* its type is the kind's; NULL: none */
    const char *left_out;         /* why there is nothing, in a text that outlives the run; NULL: nothing is left out */
    bool        coarse;           /* what it needs was not ready, and something coarser stood in */
} FrameOutput;

/* What was rendered of a snapshot: the planes, and what they were rendered from. */
typedef struct FrameView {
    Picture    picture;
    Snapshot   snapshot;
    int        plane_count;
    FrameArray plane[frame_max_planes];
    char       sha256[sha256_text_size]; /* of the planes; empty: not yet, see frame_sha256 */
} FrameView;

/* The inputs of the frame, its program and its time. */
typedef struct Provenance {
    const char *version, *config_sha256;
    long long   seed;
    uint64_t    datagrams;                    /* of the log, or received, when it was rendered */
    double      begun_s, posed_s, rendered_s; /* wall_clock_s */
} Provenance;

typedef struct Frame Frame;
struct Frame {
    int                number;
    double             time_s, unix_s; /* of the exercise */
    char               host[dis_id_text_size];
    FrameView          seen;
    FrameDisplay       display[BAND_COUNT];        /* consume_displays, if a consumer wants it */
    GroundPoint        footprint[FOOTPRINT_COUNT]; /* if a consumer wants it; as in record */
    FrameView         *without;                    /* the same without the removed entities; NULL: not requested */
    const DisEntityId *taken;                      /* [taken_count] */
    int                taken_count;
    RenderRequest      request;
    const World       *world;        /* materials and catalog alone: the tracer belongs to the next frame */
    double             rate_px_s[2]; /* image motion of the scene: column, row */
    Sun                sun;
    FrameError         error;
    FrameOutput        output[frame_max_outputs]; /* [outputs] of the instruments, in their order */
    int                outputs;
    FrameRecord        record; /* its lists and all fields of truth.jsonl; frame_sha256 is NULL */
    Provenance         provenance;
    bool               buried;          /* the sensor was below the ground */
    double             publish_begun_s; /* wall_clock_s; set when the first consumer receives it */
    LatencyTimes       times;
    Latency           *latency; /* the run's ledger; NULL: none is kept */
    uint64_t           latency_key;
    Arena             *arena;
    struct FramePool  *pool;
    int                holds; /* protected by the pool's lock */
};

/* The output of the frame's first instrument of a kind; NULL: there is none. */
const FrameOutput *frame_output(const Frame *frame, const InstrumentKind *kind);
/* Lists the planes of an image that its hash covers, as render/frame/planes.h orders them. They are borrowed from it.
 */
int frame_planes(FrameArray plane[frame_max_planes], const Picture *picture, const RenderRequest *request);
/* A plane as the hash names it, GROUP/NAME, and as two axes: rows are all its axes but the last, which is columns. */
enum { frame_plane_name_size = 64 };
Plane frame_plane(char name[frame_plane_name_size], const FrameArray *plane);
/* Computes the SHA-256 of all planes, on the first call; in the publishing thread. */
Status frame_sha256(FrameView *view);

typedef struct FramePool FramePool;

Status frame_pool_create(FramePool **out, int frames);
void   frame_pool_destroy(FramePool *pool); /* all frames must have been released. NULL is valid */
/* Takes a frame with one reference and an empty arena; waits until one is free. */
Frame *frame_pool_take(FramePool *pool);
void   frame_hold(Frame *frame);
void   frame_release(Frame *frame);

#endif
