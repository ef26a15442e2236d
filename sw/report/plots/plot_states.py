#!/usr/bin/python3
import figures

figures.main("What each port does in the cycles of a frame, point by point.", "states")
