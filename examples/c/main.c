/* Friction compensation on a microcontroller, shown on a desk: one sine, the torque that is added to it.
 * make MODEL=../../runs/demo/friction.json
 */
#include <stdio.h>

#include "friction.h"

#define PERIOD 1.0e-3F
#define STEPS 2000U

int main(void)
{
    joint_statef_t state;
    joint_inputf_t input = {.normal_load = 1.0F}; /* an extended model has more inputs: what is left out is 0 */
    float position = 0.0F;
    float velocity = 0.4F;

    joint_resetf(&state);
    for (uint32_t step = 0U; step < STEPS; step++) {
        /* a reference that swings at 1 Hz, without a call to sin */
        velocity -= PERIOD * 39.478418F * position;
        position += PERIOD * velocity;
        input.velocity_reference = velocity;
        const float torque = joint_torquef(&state, &input);
        if ((step % 100U) == 0U) {
            (void)printf("%5.2f s  %+.4f rad/s  %+.4f N*m\n", (double)(PERIOD * (float)step), (double)velocity,
                         (double)torque);
        }
    }
    return 0;
}
