// The bytes of the page that host_sim/view/CMakeLists.txt has made, or of an empty file.
  .section .rodata
  .global vbar_view_page_begin
  .global vbar_view_page_end
vbar_view_page_begin:
  .incbin VBAR_VIEW_PAGE
vbar_view_page_end:
  .byte 0
  .section .note.GNU-stack, "", %progbits
