/* sensor/instruments/instrument.h: the interface of what looks along an eye's way and measures: cameras, a radar.
 *
 * A session has a list of them, in the order of the kinds that it was opened with; several of one kind have names and
 * states of their own. In each frame an instrument first adds what it needs to the request of the shared picture, then
 * looks at that picture, at the snapshot it was made of, and where it must at poses of other times, and hands out a
 * FrameOutput. A new one is a kind (a file here) and its row of instrument_kinds. */
#ifndef SENSOR_INSTRUMENTS_INSTRUMENT_H
#define SENSOR_INSTRUMENTS_INSTRUMENT_H

#include "sensor/frame/frame.h"
#include "sensor/settings/sensors.h"

/* What instruments are made of; it outlives them. */
typedef struct InstrumentsOf {
    const Config  *config;
    const Sensors *sensors;
    const char    *isa;   /* as tracer_create */
    bool           live;  /* what is not ready is left out, not waited for */
    Cache         *cache; /* of the disk, for what it makes; NULL: none */
} InstrumentsOf;

/* Poses at other times than the frame's, at most a tick (0.01 s) before it: of pulses, of a scanner's lines. Frames and
 * units as in the structs; gimbal angles and reports are those known at the frame. For the calling thread alone. False:
 * not there at t_s (exercise time), *out is as it was. */
typedef struct InstrumentPoses {
    bool (*eye)(EyeState *out, void *of, double t_s); /* host_index is -1 */
    bool (*entity)(SnapshotEntity *out, void *of, DisEntityId id, double t_s);
    void *of;
} InstrumentPoses;

/* What a recording says of a frame in which a live node lacked what chance had not made ready. */
typedef enum InstrumentNote {
    INSTRUMENT_NOT_NOTED, /* nothing: all is there, or in a live node chance decides */
    INSTRUMENT_COARSE,    /* it looked with what is coarse */
    INSTRUMENT_ABSENT     /* it was left out */
} InstrumentNote;

/* What an instrument may look at in one frame. */
typedef struct InstrumentLook {
    Frame *frame; /* rendered: number, times, seen, request, world; its arena is for what is handed out, and
                   * an instrument fills its own part of frame->record */
    const EyeState *eye;
    unsigned        wants; /* FrameWant, of all consumers */
    int             aim;   /* snapshot index of what the eye follows, -1: none */
    double          aim_m; /* range to where that is, or was last; NAN: unknown */
    InstrumentNote  noted; /* by the recording, for instruments whose kind has something to note */
    Pool           *pool;
    InstrumentPoses poses;
} InstrumentLook;

typedef struct Instrument {
    const InstrumentKind *kind;
    const char           *name; /* of its own; outlives the run */
} Instrument;

enum { instruments_most = frame_max_outputs };

typedef struct Instruments {
    int         count;
    Instrument *instrument[instruments_most];
} Instruments;

typedef struct InstrumentReady {
    int made, waiting;
} InstrumentReady;

struct InstrumentKind {
    const char *name;
    const char *carries; /* from frame to frame, what a frame file lacks; NULL: nothing, each frame stands alone */
    const char *noted;   /* why frames lack it whose recording notes so; NULL: it leaves nothing out by chance. One kind
                          * alone has it, the radar: the notes (frame_verdict.h) name no other */
    /* Adds those that the settings ask for, by instruments_add. STATUS_BAD_VALUE, STATUS_IO, logged. */
    Status (*open)(Instruments *list, const InstrumentsOf *of);
    /* Adds to what is rendered. NULL: it needs nothing. */
    void (*request)(RenderRequest *request, const Instrument *instrument, unsigned wants);
    /* Fills arrays and record, or left_out; name and kind are set. */
    Status (*look)(FrameOutput *out, Instrument *instrument, const InstrumentLook *look);
    void (*close)(Instrument *instrument);
    /* Live: makes ready, beside the frames, what looks at the snapshot's entities will need. NULL: it needs nothing. */
    Status (*prepare)(Instrument *instrument, const Catalog *catalog, const Snapshot *snapshot);
    /* What was made so, and what is still to be made. NULL: nothing. */
    InstrumentReady (*ready)(const Instrument *instrument);
};

/* The program's kinds; NULL ends them. */
extern const InstrumentKind *const instrument_kinds[];

/* kind: as instrument_kinds. On failure the only valid call is instruments_close. */
Status instruments_open(Instruments *list, const InstrumentKind *const kind[], const InstrumentsOf *of);
void   instruments_close(Instruments *list);
/* Takes the instrument over, also when the list is full (STATUS_BAD_VALUE). */
Status instruments_add(Instruments *list, Instrument *instrument);
/* The first of a kind; NULL: there is none. */
Instrument *instruments_find(const Instruments *list, const InstrumentKind *kind);
void        instruments_request(RenderRequest *request, const Instruments *list, unsigned wants);
/* Fills frame->output: one of each instrument, in their order. */
Status instruments_look(const Instruments *list, const InstrumentLook *look);

/* Of all of them. */
Status          instruments_prepare(const Instruments *list, const Catalog *catalog, const Snapshot *snapshot);
InstrumentReady instruments_ready(const Instruments *list);

/* ---- over a run ------------------------------------------------------------------------------------- */

/* Frames in which an instrument had nothing, and why it had nothing in the last of them; frames in which it looked with
 * what is coarse. */
typedef struct InstrumentCount {
    const InstrumentKind *kind;
    const char           *name, *why;
    int                   left_out, coarse;
} InstrumentCount;

/* Counts a frame's outputs, [frame->outputs] in their order. */
void instruments_count(InstrumentCount count[instruments_most], const Frame *frame);
/* Frames that lack an instrument of this kind. */
int instruments_left_out(const InstrumentCount count[instruments_most], const InstrumentKind *kind);
int instruments_coarse(const InstrumentCount count[instruments_most], const InstrumentKind *kind); /* likewise */

#endif
