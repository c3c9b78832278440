/* terrain/earth/local_frame.c: one matrix, computed once; the conversions are in the header. */
#include "terrain/earth/local_frame.h"

Status local_frame_at(LocalFrame *out, const Geodetic *origin)
{
    LocalFrame   frame = {.origin = *origin};
    const Status status = ecef_from_geodetic(frame.origin_ecef, frame.r_ecef_from_enu, origin);
    if (status != STATUS_OK) return status;
    *out = frame;
    return STATUS_OK;
}
