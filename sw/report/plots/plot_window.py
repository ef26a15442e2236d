#!/usr/bin/python3
import figures

figures.main("Frames per second against the size of the window, a line for each combination of the other keys.", "window")
