#!/usr/bin/python3
import figures

figures.main("Frames per second against the number of banks that the allocation uses.", "banks")
