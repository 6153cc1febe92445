/* The weights file of data/networks as a constant, and how long it is. */
  .section .rodata.vbar_keypoint_weights, "a"
  .balign 16
  .global vbar_keypoint_weights
  .type vbar_keypoint_weights, %object
vbar_keypoint_weights:
  .incbin VBAR_KEYPOINT_WEIGHTS
.Lend:
  .size vbar_keypoint_weights, . - vbar_keypoint_weights

  .balign 4
  .global vbar_keypoint_weights_bytes
  .type vbar_keypoint_weights_bytes, %object
vbar_keypoint_weights_bytes:
  .4byte .Lend - vbar_keypoint_weights
  .size vbar_keypoint_weights_bytes, . - vbar_keypoint_weights_bytes

  .section .note.GNU-stack, "", %progbits
