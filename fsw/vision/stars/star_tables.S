/* The tables that toolchains/star_tables made, as constants: struct StarTables of star_tables.h. */
  .section .rodata.vbar_star_tables, "a"
  .balign 8
  .global vbar_star_tables
  .type vbar_star_tables, %object
vbar_star_tables:
  .incbin VBAR_STAR_TABLES
  .size vbar_star_tables, . - vbar_star_tables

  .section .note.GNU-stack, "", %progbits
