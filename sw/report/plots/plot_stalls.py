#!/usr/bin/python3
import figures

figures.main("The cycles in which each port waits in a frame, point by point, by cause.", "stalls")
