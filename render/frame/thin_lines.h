/* render/frame/thin_lines.h: finds what of a large target is narrower than a pixel. */
#ifndef RENDER_FRAME_THIN_LINES_H
#define RENDER_FRAME_THIN_LINES_H

#include "render/frame/passes.h"

/* Sets a flag of Job.refine at the pixels on thin pieces of an entity that lies in front of the eye: some of their rays meet such a piece and
 * others do not, and one ray a pixel shows it as dashes. */
void mark_thin_lines(Job *job, int index, uint8_t flag);

#endif
