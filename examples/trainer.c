/* trainer: all of the library at once, as in a trainer for surgeons. An organ of three materials, made from surfaces,
   breathes: what holds its back moves. Pieces touch each other, the ground and two tools. A hand goes through a round
   of 15 s at 60 frames a second (--small: 20), again and again, see trainer.h: it cuts with a blade in space, excises a
   wedge, peels a tumour, pulls, drops, drills, errs and goes back.

   --frames 36000: ten minutes; --cells 20, 26: 10,000 and 20,000 elements */
#include "trainer.h"

int main(int argc, char **argv) {
    trainer on;
    scene s;
    scene_open(&s, &trainer_scene, argc, argv);
    trainer_begin(&s, &on);
    while (s.frame < s.frames) {
        trainer_frame(&s, &on);
        trainer_watch(&s, &on);
    }
    trainer_report(&s, &on);
    trainer_end(&on);
    return scene_close(&s);
}
