/* sensor/score/truth_line.h: what scoring needs of a line of truth.jsonl. */
#ifndef SENSOR_SCORE_TRUTH_LINE_H
#define SENSOR_SCORE_TRUTH_LINE_H

#include "entities/scenery/scenery.h"
#include "render/scene/view.h"
#include "sensor/score/json_stream.h"

/* NaN: truth has none. */
typedef struct TruthTarget {
    uint64_t id;           /* of the entity (json_member_entity) */
    int      class_number; /* 0: none of target_class_name */
    double   range_m, aspect_deg, pixels, visible, foliage, snr[BAND_COUNT];
    bool     seen;              /* it has a box */
    double   box[4], amodal[4]; /* left, top, width, height, px; box: of its visible pixels */
} TruthTarget;

/* What an answer may be misled by. */
typedef struct TruthClutter {
    int    class_number; /* SceneryClass; CLUTTER_NONE: of none that this program knows */
    double box[4];       /* left, top, width, height, px */
} TruthClutter;

typedef struct TruthFrame {
    int           frame, width, height;
    double        time_s, hour, deg2, km2; /* hour: local solar time; km2: of visible ground, NaN: not known */
    unsigned      bands;
    double        focal_px, r_cam_from_enu[9]; /* enu: at the sensor */
    Lens          lens;
    int           count, room;
    TruthTarget  *target; /* [count], in truth's order; kept from line to line, as the next and text */
    uint64_t     *sorted; /* [count] their ids, ascending */
    int           clutter_count, clutter_room;
    TruthClutter *clutter; /* [clutter_count], in truth's order; kept likewise */
    size_t        text_room;
    char         *text; /* what is wanted of the line */
} TruthFrame;

/* Overwrites *out, whose list it may make longer. STATUS_BAD_VALUE, logged: not a frame of truth, or the same entity
 * twice. STATUS_NO_MEMORY. */
Status truth_line_read(TruthFrame *out, const JsonStream *line);
void   truth_frame_free(TruthFrame *frame);

/* Where a line of sight, deg, falls on the image; false: behind the camera. */
bool truth_frame_point(double point_px[2], const TruthFrame *frame, double azimuth_deg, double elevation_deg);

#endif
