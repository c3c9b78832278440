/* sensor/verify/saved_frame/frame_save.h: writes a frame that was just rendered as OUT/frame_NNNNNN.pvf
 * (saved_frame.h). */
#ifndef SENSOR_VERIFY_SAVED_FRAME_FRAME_SAVE_H
#define SENSOR_VERIFY_SAVED_FRAME_FRAME_SAVE_H

#include "sensor/frame/frame.h"
#include "sensor/frame/frame_scenery.h"
#include "sensor/settings/config.h"

typedef struct FrameSave {
    const Frame        *frame; /* complete, with planes of truth; its planes are compared with those of the file */
    const Config       *config;
    const char         *out; /* folder; exists */
    const EyeState     *eye;
    double              unix_s; /* Unix time of exercise time 0 */
    bool                all_on_ground;
    Pool               *pool;
    const WoodsConfig  *woods;   /* of the world's plants; NULL: none */
    const FrameScenery *scenery; /* that of the world; NULL: none */
} FrameSave;

/* Writes a frame file after rendering it again from its own octets to the same bits; with terrain from files it
 * includes more of the terrain until they agree. Takes the time of a few frames. Failures are logged. */
Status frame_save(const FrameSave *save);

#endif
