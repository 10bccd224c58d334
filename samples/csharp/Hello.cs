// SPDX-License-Identifier: MIT
// Hello.exe ASSET.sphc PALETTES: which body parts are inside each other, frame by frame. The same lines as samples/hello.
using System;
using System.Globalization;
using System.IO;
using Spherechain;

public static class Hello
{
    static void Play(byte[] file, Palettes clip)
    {
        // [hello]
        // Your skeleton: names and inverse bind matrices. All memory is allocated here, never in a frame.
        using (Model model = new Model(file, clip.Joints, clip.InverseBinds, MatrixLayout.Columns4x4))
        using (Body body = new Body(model))
        {
            model.CheckRest(clip.Rest, MatrixLayout.Columns4x4);
            for (int frame = 0; frame < clip.Frames.Length; ++frame)
            {
                body.SetPose(clip.Frames[frame], MatrixLayout.Columns4x4);  // what your skinning shader gets
                foreach (Penetration found in body.Penetrations()) Print(frame, model, found);
            }
        }
        // [/hello]
    }

    static void Print(int frame, Model model, Penetration found)
    {
        Vec3 way = found.Direction;  // the way that the part must go
        Console.WriteLine("frame {0}: {1} in {2}, {3} mm; out along ({4}, {5}, {6})", frame, model.PartName(found.Part),
                          model.PartName(found.Other), Number(model.Millimetres(found.Measures.Depth), "F0"),
                          Number(way.X, "F2"), Number(way.Y, "F2"), Number(way.Z, "F2"));
    }

    // As C prints it: with the sign of -0.00.
    static string Number(float value, string format)
    {
        bool isNegative = value < 0 || (value == 0 && 1 / value < 0);
        return (isNegative ? "-" : "") + Math.Abs((double)value).ToString(format, CultureInfo.InvariantCulture);
    }

    public static int Main(string[] arguments)
    {
        if (arguments.Length != 2)
        {
            Console.Error.WriteLine("usage: Hello.exe ASSET.sphc PALETTES");
            return 2;
        }
        try
        {
            Play(File.ReadAllBytes(arguments[0]), new Palettes(arguments[1]));
            return 0;
        }
        catch (Exception error) when (error is SpherechainException || error is IOException)
        {
            Console.Error.WriteLine("hello: error: " + error.Message);
            return 3;
        }
    }
}
