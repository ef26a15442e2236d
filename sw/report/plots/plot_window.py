#!/usr/bin/python3
import figures

figures.main("Frames per second against the size of the window.", "window")
