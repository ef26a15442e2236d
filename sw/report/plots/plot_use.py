#!/usr/bin/python3
import figures

figures.main("How busy each bank is while the core works on a frame, point by point.", "use")
