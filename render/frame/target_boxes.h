/* render/frame/target_boxes.h: where targets lie on the image. */
#ifndef RENDER_FRAME_TARGET_BOXES_H
#define RENDER_FRAME_TARGET_BOXES_H

#include "render/frame/passes.h"

/* A pool task: the whole box of entity `index`, into Job.boxes. */
void project_target(void *job, int worker, int index);

#endif
