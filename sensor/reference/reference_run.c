/* sensor/reference/reference_run.c: run.json. */
#include "sensor/reference/reference.h"

#include "dis/cigi/cigi_datagram.h"
#include "dis/pdu/pdu.h"
#include "render/trace/visibility/visibility.h"
#include "sensor/node/run/run_record.h"
#include "sensor/node/session/session.h"

static const char *drop(int i) { return i < DIS_DROP_COUNT ? dis_drop_name((DisDrop)i) : NULL; }
static const char *skip(int i) { return i < SKIP_COUNT ? visibility_skip_name((Skip)i) : NULL; }
static const char *what_skip(int i) { return visibility_skip_what((Skip)i); }
static const char *kind(int i) { return i < PLANT_STANDING ? plant_name((PlantKind)i) : NULL; }
static const char *clutter(int i) { return i + 1 < CLUTTER_CLASSES ? scenery_class_name((SceneryClass)(i + 1)) : NULL; }
static const char *stage(int i) { return i < session_stages ? session_stage_name[i] : NULL; }

/* Gives the reasons that are faults. */
static const char *answer_fault(int i)
{
    const int reason = i + 1 + (i + 1 >= ANSWER_LATE);
    return reason < ANSWER_REASONS ? answer_reason_name[reason] : NULL;
}

static const char *flaw(int i) { return i < CIGI_DROP_COUNT ? cigi_drop_name((CigiDrop)i) : NULL; }

static const char *mistake(int i) { return i + 1 < HEAD_DROPS ? head_drop_name[i + 1] : NULL; }

static const char *form(int i) { return i < ANSWER_FORMS ? answer_form_name[i] : NULL; }

static const char *latency(int i) { return i < LATENCY_STAGE_COUNT ? latency_stage_name[i] : NULL; }

static const ReferenceWord words[] = {
    {"KEY", "a setting's section and key with a dot between, such as sensor.width_px", NULL, NULL},
    {"FILE", "catalog.csv, atmosphere/midlat_summer, a model's file as the catalog names it", NULL, NULL},
    {"LIBRARY", "embree, openimageio, geographiclib, erfa, fftw, libc, compiler", NULL, NULL},
    {"TYPE", "the PDU type's number: 1 Entity State, 2 Fire, 3 Detonation ...", NULL, NULL},
    {"REASON", "one of", drop, NULL},
    {"FLAW", "one of", flaw, NULL},
    {"MISTAKE", "one of", mistake, NULL},
    {"PACKET", "the CIGI packet's id: 3 Conformal Clamped Entity Control, 4 Component Control ...", NULL, NULL},
    {"FORM", "one of", form, NULL},
    {"FAULT", "one of", answer_fault, NULL},
    {"SKIP", "one of", skip, what_skip},
    {"KIND", "one of", kind, NULL},
    {"CLUTTER", "one of", clutter, NULL},
    {"STAGE", "one of", stage, NULL},
    {"LATENCY", "one of", latency, NULL},
    REFERENCE_WORD_CONSUMER,
};

const Reference reference_run = {
    .topic = "run.json",
    .file = "run.json",
    .title = "the run: settings, hashes, choices, counters, times",
    .about = "Written at the end of a run, also of one that was stopped. Two runs with the same config_sha256, "
             "log_sha256,\n"
             "tables_sha256, version and libraries have the same frame_sha256.",
    .table = &run_record_fields,
    .word = REFERENCE_FIELDS(words),
    .python = "import json\n"
              "run = json.load(open('run.json'))\n"
              "print(run['pitviper'], run['frames'], 'frames from', ', '.join(run['hosts']))\n"
              "for line in run['choices']:\n"
              "    print('chosen:', line)\n"
              "hashes = dict(zip(run['frame_number'], run['frame_sha256']))\n"
              "lost = {why: n for why, n in run['counters']['dropped'].items() if n}\n"
              "print(lost, run['timings_ms']['frame']['median'], 'ms a frame', len(hashes))\n",
};
