// The style sheet and the scripts of the page, as bytes in the program.
  .section .rodata
  .global stereotlm_page_style, stereotlm_page_style_end, stereotlm_page_script, stereotlm_page_script_end
stereotlm_page_style:
  .incbin "style.css"
stereotlm_page_style_end:
stereotlm_page_script:
  .incbin "page.js"
stereotlm_page_script_end:
  .section .note.GNU-stack, "", %progbits
